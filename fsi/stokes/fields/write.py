"""Flow fields on disk: one VTU file per step and rank, with curved cells of the velocity's own degree.

Gradients of finite elements jump from cell to cell. At a node that cells share the file has the mean of
their values: continuous, as drawings want it, and the same on any number of ranks. `fsi probe` gives the
values of each cell itself.
"""

from __future__ import annotations

from pathlib import Path

import basix
import meshio
import numpy as np
from dolfinx import la
from numpy.typing import NDArray

import fsi.parallel as parallel
from fsi.bodies.configuration import Array
from fsi.errors import SolveError
from fsi.meshes.cells.lagrange import gradient
from fsi.meshes.files.write import vtk_order
from fsi.observables.velocity_gradient import hoop_rate, strain_rate, vorticity
from fsi.stokes.fields.flow import Flow
from fsi.stokes.fields.traction import Surface

CELLS = {1: "VTK_LAGRANGE_CURVE", 2: "VTK_LAGRANGE_TRIANGLE", 3: "VTK_LAGRANGE_TETRAHEDRON"}


def in_space(vectors: Array) -> Array:
    """Vectors (n, d) with a third component, zero in the plane, (n, 3)."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def write_flow(flow: Flow, folder: Path, step: int) -> list[str]:
    """Write `fluid_<step>.vtu`, on several ranks one file each; names of all ranks' files.

    u and p are the finite element's own values at its nodes; vorticity and strain rate are nodal means.
    """
    part = "" if parallel.size() == 1 else f"_rank{parallel.rank()}"
    name = f"fluid_{step:06d}{part}.vtu"
    mesh = _mesh(flow.x, flow.cells, flow.x.shape[1])
    mesh.point_data = {"velocity": in_space(flow.u), "pressure": flow.p, **_nodal_rates(flow)}
    parallel.on_every_rank(lambda: _write(folder / name, mesh))
    return parallel.gather(name)


def write_surface(surface: Surface, traction: Array, folder: Path, step: int) -> list[str]:
    """Write `surface_<step>.vtu` on root: curved facets with the traction sigma n and the body's number."""
    name = f"surface_{step:06d}.vtu"
    mesh = _mesh(surface.x, surface.facets, surface.x.shape[1] - 1)
    mesh.point_data, mesh.cell_data = {"traction": in_space(traction)}, {"body": [surface.body]}
    parallel.on_root(lambda: _write(folder / name, mesh))
    return [name]


def _mesh(x: Array, cells: NDArray[np.int64], dimension: int) -> meshio.Mesh:
    """Nodes x (n, d) and curved cells of that dimension, nodes in the order of basix."""
    return meshio.Mesh(in_space(x), [(CELLS[dimension], cells[:, vtk_order(cells.shape[1], dimension)])])


def _write(path: Path, mesh: meshio.Mesh) -> None:
    """Write a VTU file to a temporary name and rename it.

    Raises:
        SolveError: the disk refuses.
    """
    temporary = path.with_name(f".{path.name}.partial")
    try:
        meshio.write(temporary, mesh, file_format="vtu")
        temporary.replace(path)
    except OSError as error:
        raise SolveError(f"cannot write {path}: {error.strerror}") from error


def _nodal_rates(flow: Flow) -> dict[str, Array]:
    """`vorticity`, (n,) or in space (n, 3), and `strain_rate` (n,) at this rank's nodes; collective."""
    x, u = flow.x[flow.cells], flow.u[flow.cells]
    G = gradient(x[:, None], u[:, None], _slopes(flow.degree, x.shape[2]))
    hoop = hoop_rate(x[..., 0], u[..., 0], G) if flow.axisymmetric else 0.0
    values = np.concatenate(
        [np.atleast_3d(vorticity(G)), strain_rate(G, hoop)[..., None], np.ones((*flow.cells.shape, 1))],
        axis=2,
    )
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
    element = basix.create_element(basix.ElementFamily.P, cell, degree, basix.LagrangeVariant.equispaced)
    slopes: Array = element.tabulate(1, element.points)[1:, :, :, 0]
    return np.moveaxis(slopes, 0, -1)
