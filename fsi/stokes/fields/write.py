"""Flow fields on disk: one VTU file per step and rank, with curved cells of the velocity's own degree."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from fsi import parallel
from fsi.bodies.configuration import Array
from fsi.errors import SolveError
from fsi.meshes.files.write import vtk_order
from fsi.stokes.fields.flow import Flow
from fsi.stokes.fields.nodal_rates import nodal_rates
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
    mesh.point_data = {"velocity": in_space(flow.u), "pressure": flow.p, **nodal_rates(flow)}
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
