"""The traction on the bodies, from the nodal reactions.

The multiplier lives in the dual of the velocity trace: one force per node. The traction t that it
stands for solves  int t . v ds = sum lambda . v  for every trace v; it converges two orders faster
than sigma_h n. A surface has few nodes, so root collects it and solves there.
"""

from __future__ import annotations

from dataclasses import dataclass

import basix
import numpy as np
import scipy.sparse as sp
from dolfinx import fem
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve

from fsi.bodies import Array
from meshes.aliases import FunctionSpace
from meshes.build import FluidMesh


@dataclass(frozen=True, slots=True)
class Surface:
    """The bodies' surfaces as curved edges; empty on all ranks but root.

    x: nodes (n, 2); edges: node numbers, (E, degree + 1), both ends first as VTK has them;
    body: of each edge, (E,); reaction: nodal forces (n, 2) of the body on the fluid, with an axis of whole
    circles; axisymmetric: x are (r, z).
    """

    x: Array
    edges: NDArray[np.int64]
    body: NDArray[np.int64]
    reaction: Array
    axisymmetric: bool


def collect(fluid: FluidMesh, V: FunctionSpace, reaction: Array) -> Surface:
    """Gather the surfaces of all bodies on root; collective. reaction: this rank's rows of u."""
    tags = fluid.facet_tags
    on_body = (tags.values >= 1) & (tags.values <= fluid.bodies)
    facets, body = tags.indices[on_body], tags.values[on_body] - 1
    entities = fem.compute_integration_domains(fem.IntegralType.exterior_facet, fluid.mesh.topology, facets)
    closure = np.array(V.element.basix_element.entity_closure_dofs[1])
    local = V.dofmap.list[entities[::2][:, None], closure[entities[1::2]]]
    numbers = V.dofmap.index_map.local_to_global(local.ravel().astype(np.int32)).reshape(local.shape)
    mine = np.unique(local)
    lambda_h = fem.Function(V)
    lambda_h.x.array[: len(reaction)] = reaction
    lambda_h.x.scatter_forward()
    values = lambda_h.x.array.reshape(-1, 2)[mine]
    x = V.tabulate_dof_coordinates()[mine, :2]
    node = V.dofmap.index_map.local_to_global(mine.astype(np.int32))
    parts = fluid.mesh.comm.gather((node, x, values, numbers, body))
    if parts is None:
        none, nothing = np.empty((0, 2)), np.empty(0, dtype=np.int64)
        return Surface(none, nothing.reshape(0, 2), nothing, none, fluid.axisymmetric)
    nodes, xs, reactions, edges, bodies = (np.concatenate([part[k] for part in parts]) for k in range(5))
    unique, first = np.unique(nodes, return_index=True)
    return Surface(xs[first], np.searchsorted(unique, edges), bodies, reactions[first], fluid.axisymmetric)


def traction(surface: Surface) -> Array:
    """Traction sigma n at the surface nodes (n, 2), n out of the fluid: solve the surface mass matrix."""
    if len(surface.edges) == 0:
        return np.empty((0, 2))
    degree = surface.edges.shape[1] - 1
    element = basix.create_element(
        basix.ElementFamily.P, basix.CellType.interval, degree, basix.LagrangeVariant.equispaced
    )
    points, weights = basix.make_quadrature(basix.CellType.interval, 3 * degree)
    phi, dphi = element.tabulate(1, points)[:, :, :, 0]
    tangent = np.einsum("qn,end->eqd", dphi, surface.x[surface.edges])
    length = weights * np.hypot(tangent[..., 0], tangent[..., 1])
    if surface.axisymmetric:
        length *= 2.0 * np.pi * (surface.x[surface.edges, 0] @ phi.T)
    masses = np.einsum("eq,qi,qj->eij", length, phi, phi)
    rows = np.repeat(surface.edges, degree + 1, axis=1).ravel()
    columns = np.tile(surface.edges, (1, degree + 1)).ravel()
    mass = sp.csc_matrix((masses.ravel(), (rows, columns)))
    t: Array = spsolve(mass, surface.reaction)
    return t.reshape(-1, 2)
