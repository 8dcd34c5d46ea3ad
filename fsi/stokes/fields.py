"""The flow as fields: curved cells whose nodes carry velocity and pressure, surfaces, and their files.

Files are VTU, one per step and rank, with curved cells of the velocity's own degree. Gradients of finite
elements jump from cell to cell. At a node that cells share the file has the mean of their values: continuous,
as drawings want it, and the same on any number of ranks. `fsi probe` gives the values of each cell itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import basix
import numpy as np
from dolfinx import fem, la
from dolfinx.common import IndexMap
from mpi4py import MPI
from numpy.typing import NDArray

import fsi.parallel as parallel
from fsi.arrays import Array
from fsi.meshes.cells.lagrange import gradient, locate, tabulate
from fsi.meshes.files.write import vtk_order
from fsi.meshes.geometry.lattice import Lattice
from fsi.observables.kinematics import hoop_rate, strain_rate, vorticity
from fsi.run_folder.paraview import in_space, write_vtu
from fsi.stokes.discretisation.forms import EQUISPACED, Forms
from fsi.stokes.solvers.system import StokesSystem

if TYPE_CHECKING:
    import meshio

# How far beyond its cell a point counts as in it, in sizes of the cell: one that is on a body to rounding.
BEYOND = 1e-4


@dataclass(frozen=True, slots=True)
class Flow:
    """This rank's cells: Lagrange triangles or tetrahedra whose nodes carry velocity and pressure.

    Attributes:
        x: nodes, (n, d).
        cells: node numbers in the order of basix, (T, nodes).
        u: velocities, (n, d).
        p: pressures, (n,).
        degree: of the cells.
        nodes: which of the nodes other ranks have too.
        axisymmetric: whether x are (r, z).
    """

    x: Array
    cells: NDArray[np.int64]
    u: Array
    p: Array
    degree: int
    nodes: IndexMap
    axisymmetric: bool


def capture(forms: Forms, x: Array) -> Flow:
    """Copy the flow that stands in `forms`, with its nodes x, which it keeps."""
    V, topology = forms.V, forms.mesh.topology
    d = topology.dim
    cells = V.dofmap.list[: topology.index_map(d).size_local]
    element, u = V.element.basix_element, np.array(forms.u.x.array, dtype=np.float64).reshape(-1, d)
    # The pressure at the nodes of the velocity is exact, since the element of V holds that of Q.
    phi = forms.Q.element.basix_element.tabulate(0, element.points)[0, :, :, 0]
    p = np.empty(len(u))
    p[cells] = forms.p.x.array[forms.Q.dofmap.list[: len(cells)]] @ phi.T
    return Flow(x, cells.astype(np.int64), u, p, element.degree, V.dofmap.index_map, forms.axisymmetric)


def values_at(flow: Flow, points: Array) -> Array:
    """u and p, the elements' own, at points (n, d): (n, d + 1), NaN where there is no cell; collective.

    All ranks ask for the same points and get all values.
    """
    cells = flow.cells[:, vtk_order(flow.cells.shape[1], points.shape[1])]
    cell, X = locate(flow.x[cells], points, BEYOND)
    inside = cell >= 0
    phi, _ = tabulate(flow.degree, X[inside])
    values = np.full((len(points), points.shape[1] + 1), np.nan)
    nodes = cells[cell[inside]]
    values[inside] = np.einsum("pn,pnc->pc", phi, np.column_stack([flow.u, flow.p])[nodes])
    # Where ranks meet, the first that knows a point speaks: all have the same values then.
    first, *others = parallel.gather(values)
    for other in others:
        first = np.where(np.isnan(first), other, first)
    return first


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


def surfaces(system: StokesSystem, reaction: Array) -> Surface:
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
    met = np.zeros(len(x), dtype=bool)
    met[local] = True
    mine = np.flatnonzero(met)
    lambda_h = fem.Function(V)
    lambda_h.x.array[: len(reaction)] = reaction
    lambda_h.x.scatter_forward()
    values = lambda_h.x.array.reshape(-1, d)[mine]
    node = V.dofmap.index_map.local_to_global(mine.astype(np.int32))
    parts = MPI.COMM_WORLD.gather((node, x[mine], values, numbers, body))
    if parts is None:
        parts = [(node[:0], x[:0], values[:0], numbers[:0], body[:0])]
    nodes, xs, reactions, numbers, bodies = (np.concatenate([part[k] for part in parts]) for k in range(5))
    unique, first = np.unique(nodes, return_index=True)
    of_facets = np.searchsorted(unique, numbers)
    return Surface(
        xs[first], of_facets, degree, bodies, reactions[first], fluid.lattice, fluid.container.axisymmetric
    )


CELLS = {1: "VTK_LAGRANGE_CURVE", 2: "VTK_LAGRANGE_TRIANGLE", 3: "VTK_LAGRANGE_TETRAHEDRON"}


def write_flow(flow: Flow, folder: Path, step: int) -> list[str]:
    """Write `fluid_<step>.vtu`, on several ranks one file each; names of all ranks' files.

    u and p are the finite element's own values at its nodes; vorticity and strain rate are nodal means.
    """
    part = "" if parallel.size() == 1 else f"_rank{parallel.rank()}"
    name = f"fluid_{step:06d}{part}.vtu"
    mesh = _mesh(flow.x, flow.cells, flow.x.shape[1])
    mesh.point_data = {"velocity": in_space(flow.u), "pressure": flow.p, **_nodal_rates(flow)}
    parallel.on_every_rank(lambda: write_vtu(folder / name, mesh))
    return parallel.gather(name)


def write_surface(surface: Surface, traction: Array, folder: Path, step: int) -> list[str]:
    """Write `surface_<step>.vtu` on root: curved facets with the traction sigma n and the body's number."""
    name = f"surface_{step:06d}.vtu"
    mesh = _mesh(surface.x, surface.facets, surface.x.shape[1] - 1)
    mesh.point_data, mesh.cell_data = {"traction": in_space(traction)}, {"body": [surface.body]}
    parallel.on_root(lambda: write_vtu(folder / name, mesh))
    return [name]


def _mesh(x: Array, cells: NDArray[np.int64], dimension: int) -> meshio.Mesh:
    """Nodes x (n, d) and curved cells of that dimension, nodes in the order of basix."""
    import meshio  # takes a tenth of a second to load

    return meshio.Mesh(in_space(x), [(CELLS[dimension], cells[:, vtk_order(cells.shape[1], dimension)])])


def _nodal_rates(flow: Flow) -> dict[str, Array]:
    """`vorticity`, (n,) or in space (n, 3), and `strain_rate` (n,) at this rank's nodes; collective."""
    x, u = flow.x[flow.cells], flow.u[flow.cells]
    G = gradient(x[:, None], u[:, None], _slopes(flow.degree, x.shape[2]))
    hoop = hoop_rate(x[..., 0], u[..., 0], G) if flow.axisymmetric else 0.0
    ones = np.ones((*flow.cells.shape, 1))
    values = np.concatenate([np.atleast_3d(vorticity(G)), strain_rate(G, hoop)[..., None], ones], axis=2)
    sums = la.vector(flow.nodes, bs=values.shape[2])
    table = sums.array.reshape(-1, values.shape[2])
    for k in range(values.shape[2]):
        table[:, k] = np.bincount(flow.cells.ravel(), values[..., k].ravel(), minlength=len(table))
    sums.scatter_reverse(la.InsertMode.add)
    sums.scatter_forward()
    means = table[:, :-1] / np.maximum(table[:, -1:], 1.0)
    curl = means[:, 0] if means.shape[1] == 2 else means[:, :-1]
    return {"vorticity": curl, "strain_rate": means[:, -1]}


def _slopes(degree: int, dimension: int) -> Array:
    """Gradients of the shape functions at the nodes, (nodes, nodes, d), both in the order of basix."""
    cell = {2: basix.CellType.triangle, 3: basix.CellType.tetrahedron}[dimension]
    element = basix.create_element(basix.ElementFamily.P, cell, degree, EQUISPACED)
    slopes: Array = element.tabulate(1, element.points)[1:, :, :, 0]
    return np.moveaxis(slopes, 0, -1)
