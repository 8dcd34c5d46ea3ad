"""The traction on the bodies, from the nodal reactions.

The multiplier lives in the dual of the velocity trace: one force per node. The traction t that it
stands for solves  int t . v ds = sum lambda . v  for every trace v; it converges two orders faster
than sigma_h n. A surface has few nodes, so root collects it and solves there.

Where a periodic domain is opened at a body, one node of its surface stands there twice, at two images, and
each copy has the reaction of the fluid on its own side: v and t have one value at both.
"""

from __future__ import annotations

from dataclasses import dataclass

import basix
import numpy as np
import scipy.sparse as sp
from dolfinx import fem
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from fsi.bodies.configuration import Array
from fsi.meshes.geometry.lattice import SAME_PLACE, Integers, Lattice, on_torus
from fsi.stokes.solvers.elimination import StokesSystem

FACET = {2: basix.CellType.interval, 3: basix.CellType.triangle}


@dataclass(frozen=True, slots=True)
class Surface:
    """The bodies' surfaces as curved facets, edges or in space triangles; empty on all ranks but root.

    Attributes:
        x: nodes, (n, d).
        facets: node numbers in the order of basix, (E, nodes).
        degree: of the facets.
        body: of each facet, (E,).
        reaction: nodal forces of the body on the fluid, (n, d), with an axis those of whole circles.
        lattice: of the images.
        axisymmetric: whether x are (r, z).
    """

    x: Array
    facets: NDArray[np.int64]
    degree: int
    body: NDArray[np.int64]
    reaction: Array
    lattice: Lattice
    axisymmetric: bool


def collect(system: StokesSystem, reaction: Array) -> Surface:
    """Gather the surfaces of all bodies on root; collective. reaction: this rank's rows of u."""
    fluid, V, x = system.problem.fluid, system.forms.V, system.nodes.with_ghosts
    tags = fluid.facet_tags
    on_body = (tags.values >= 1) & (tags.values <= fluid.bodies)
    facets, body = tags.indices[on_body], tags.values[on_body] - 1
    entities = fem.compute_integration_domains(fem.IntegralType.exterior_facet, fluid.mesh.topology, facets)
    d, degree = fluid.dimension, V.element.basix_element.degree
    closure = np.array(V.element.basix_element.entity_closure_dofs[d - 1])
    local = V.dofmap.list[entities[::2][:, None], closure[entities[1::2]]]
    numbers = V.dofmap.index_map.local_to_global(local.ravel().astype(np.int32)).reshape(local.shape)
    mine = np.unique(local)
    lambda_h = fem.Function(V)
    lambda_h.x.array[: len(reaction)] = reaction
    lambda_h.x.scatter_forward()
    values = lambda_h.x.array.reshape(-1, d)[mine]
    node = V.dofmap.index_map.local_to_global(mine.astype(np.int32))
    parts = fluid.mesh.comm.gather((node, x[mine], values, numbers, body))
    if parts is None:
        parts = [(node[:0], x[:0], values[:0], numbers[:0], body[:0])]
    nodes, xs, reactions, numbers, bodies = (np.concatenate([part[k] for part in parts]) for k in range(5))
    unique, first = np.unique(nodes, return_index=True)
    of_facets = np.searchsorted(unique, numbers)
    return Surface(
        xs[first], of_facets, degree, bodies, reactions[first], fluid.lattice, fluid.container.axisymmetric
    )


def places(surface: Surface) -> Integers:
    """For each node (n,) the number of its place: images on one body have the same, 0, 1, ... all told."""
    x, lattice = surface.x, surface.lattice
    place = np.arange(len(x))
    if lattice.dimension == 0:
        return place
    of_node = np.empty(len(x))
    of_node[surface.facets] = surface.body[:, None]
    torus = np.column_stack([on_torus(x, lattice), lattice.longest() * of_node])
    one, other = cKDTree(torus).query_pairs(SAME_PLACE * lattice.longest(), output_type="ndarray").T
    place[np.maximum(one, other)] = np.minimum(one, other)
    return np.unique(place, return_inverse=True)[1]


def traction(surface: Surface) -> Array:
    """Traction sigma n at the surface nodes (n, d), n out of the fluid: solve the surface mass matrix."""
    facets, d = surface.facets, surface.x.shape[1]
    if len(facets) == 0:
        return np.empty((0, d))
    element = basix.create_element(
        basix.ElementFamily.P, FACET[d], surface.degree, basix.LagrangeVariant.equispaced
    )
    points, weights = basix.make_quadrature(FACET[d], 3 * surface.degree)
    phi, *dphi = element.tabulate(1, points)[:, :, :, 0]
    tangents = [np.einsum("qn,end->eqd", along, surface.x[facets]) for along in dphi]
    area = weights * np.linalg.norm(tangents[0] if d == 2 else np.cross(*tangents), axis=2)
    if surface.axisymmetric:
        area *= 2.0 * np.pi * (surface.x[facets, 0] @ phi.T)
    masses = np.einsum("eq,qi,qj->eij", area, phi, phi)
    place = places(surface)
    of_facets = place[facets]
    rows = np.repeat(of_facets, of_facets.shape[1], axis=1).ravel()
    columns = np.tile(of_facets, (1, of_facets.shape[1])).ravel()
    mass = sp.csc_matrix((masses.ravel(), (rows, columns)))
    reaction = np.zeros((mass.shape[0], d))
    np.add.at(reaction, place, surface.reaction)
    t: Array = spsolve(mass, reaction).reshape(-1, d)
    return t[place]
