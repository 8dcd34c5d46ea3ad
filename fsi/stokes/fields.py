"""Flow fields on disk: one VTU file per step and rank, with curved cells of the velocity's own degree."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from fsi import parallel
from fsi.bodies import Array
from fsi.errors import SolveError
from fsi.stokes.forms import Forms
from fsi.stokes.surface import Surface
from meshes.convert import vtk_order


@dataclass(frozen=True, slots=True)
class Flow:
    """This rank's cells as VTK draws them: Lagrange triangles whose nodes carry velocity and pressure.

    x: (n, 2); cells: node numbers in VTK's order, (T, nodes); u: (n, 2); p: (n,).
    """

    x: Array
    cells: NDArray[np.int64]
    u: Array
    p: Array


def capture(forms: Forms) -> Flow:
    """Copy the flow that stands in `forms`, with the mesh as it is now."""
    V, topology = forms.V, forms.mesh.topology
    cells = V.dofmap.list[: topology.index_map(2).size_local]
    order = vtk_order(cells.shape[1])
    x: Array = V.tabulate_dof_coordinates()[:, :2].copy()
    return Flow(
        x,
        cells[:, order].astype(np.int64),
        np.array(forms.u.x.array, dtype=np.float64).reshape(-1, 2),
        _pressure_at_nodes(forms, cells),
    )


def _pressure_at_nodes(forms: Forms, cells: NDArray[np.int32]) -> Array:
    """The pressure at the nodes of the velocity: exact, since the element of V holds that of Q."""
    points = forms.V.element.basix_element.points
    phi = forms.Q.element.basix_element.tabulate(0, points)[0, :, :, 0]
    p = np.empty(len(forms.u.x.array) // 2)
    p[cells] = forms.p.x.array[forms.Q.dofmap.list[: len(cells)]] @ phi.T
    return p


def write_flow(flow: Flow, folder: Path, step: int) -> list[str]:
    """Write `fluid_<step>.vtu`, on several ranks one file each; names of all ranks' files."""
    part = "" if parallel.size() == 1 else f"_rank{parallel.rank()}"
    name = f"fluid_{step:06d}{part}.vtu"
    data = {"velocity": np.column_stack([flow.u, np.zeros(len(flow.u))]), "pressure": flow.p}
    parallel.on_every_rank(
        lambda: _write(folder / name, flow.x, "VTK_LAGRANGE_TRIANGLE", flow.cells, data, {})
    )
    return parallel.gather(name)


def write_surface(surface: Surface, traction: Array, folder: Path, step: int) -> list[str]:
    """Write `surface_<step>.vtu` on root: curved edges with the traction sigma n and the body's number."""
    name = f"surface_{step:06d}.vtu"
    data = {"traction": np.column_stack([traction, np.zeros(len(traction))])}
    parallel.on_root(
        lambda: _write(
            folder / name, surface.x, "VTK_LAGRANGE_CURVE", surface.edges, data, {"body": [surface.body]}
        )
    )
    return [name]


def _write(
    path: Path,
    x: Array,
    cell: str,
    cells: NDArray[np.int64],
    data: dict[str, Array],
    cell_data: dict[str, list[NDArray[np.int64]]],
) -> None:
    """Write a VTU file to a temporary name and rename it.

    Raises:
        SolveError: the disk refuses.
    """
    mesh = meshio.Mesh(
        np.column_stack([x, np.zeros(len(x))]), [(cell, cells)], point_data=data, cell_data=cell_data
    )
    temporary = path.with_name(f".{path.name}.partial")
    try:
        meshio.write(temporary, mesh, file_format="vtu")
        temporary.replace(path)
    except OSError as error:
        raise SolveError(f"cannot write {path}: {error.strerror}") from error
