"""Flow fields on disk: one VTU file per step and rank, with curved cells of the velocity's own degree."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np
from dolfinx.common import IndexMap
from numpy.typing import NDArray

from fsi import parallel
from fsi.bodies.configuration import Array
from fsi.errors import SolveError
from fsi.meshes.files.write import vtk_order
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.fields.nodal_rates import nodal_rates
from fsi.stokes.fields.traction import Surface

CELLS = {1: "VTK_LAGRANGE_CURVE", 2: "VTK_LAGRANGE_TRIANGLE", 3: "VTK_LAGRANGE_TETRAHEDRON"}


@dataclass(frozen=True, slots=True)
class Flow:
    """This rank's cells: Lagrange triangles or tetrahedra whose nodes carry velocity and pressure.

    x: (n, d); cells: node numbers in the order of basix, (T, nodes); u: (n, d); p: (n,);
    degree: of the cells; nodes: which of them other ranks have too; axisymmetric: x are (r, z).
    """

    x: Array
    cells: NDArray[np.int64]
    u: Array
    p: Array
    degree: int
    nodes: IndexMap
    axisymmetric: bool


def in_space(vectors: Array) -> Array:
    """Vectors (n, d) with a third component, zero in the plane, (n, 3)."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def capture(forms: Forms, x: Array) -> Flow:
    """Copy the flow that stands in `forms`, with its nodes x, which it keeps."""
    V, topology = forms.V, forms.mesh.topology
    d = topology.dim
    cells = V.dofmap.list[: topology.index_map(d).size_local]
    return Flow(
        x,
        cells.astype(np.int64),
        np.array(forms.u.x.array, dtype=np.float64).reshape(-1, d),
        _pressure_at_nodes(forms, cells),
        V.element.basix_element.degree,
        V.dofmap.index_map,
        forms.axisymmetric,
    )


def _pressure_at_nodes(forms: Forms, cells: NDArray[np.int32]) -> Array:
    """The pressure at the nodes of the velocity: exact, since the element of V holds that of Q."""
    points = forms.V.element.basix_element.points
    phi = forms.Q.element.basix_element.tabulate(0, points)[0, :, :, 0]
    p = np.empty(len(forms.u.x.array) // forms.mesh.topology.dim)
    p[cells] = forms.p.x.array[forms.Q.dofmap.list[: len(cells)]] @ phi.T
    return p


def write_flow(flow: Flow, folder: Path, step: int) -> list[str]:
    """Write `fluid_<step>.vtu`, on several ranks one file each; names of all ranks' files.

    u and p are the finite element's own values at its nodes; vorticity and strain rate are nodal means.
    """
    part = "" if parallel.size() == 1 else f"_rank{parallel.rank()}"
    name = f"fluid_{step:06d}{part}.vtu"
    data = {"velocity": in_space(flow.u), "pressure": flow.p, **nodal_rates(flow)}
    parallel.on_every_rank(lambda: _write(folder / name, flow.x, flow.x.shape[1], flow.cells, data, {}))
    return parallel.gather(name)


def write_surface(surface: Surface, traction: Array, folder: Path, step: int) -> list[str]:
    """Write `surface_<step>.vtu` on root: curved facets with the traction sigma n and the body's number."""
    name = f"surface_{step:06d}.vtu"
    d, data, of_cells = surface.x.shape[1], {"traction": in_space(traction)}, {"body": [surface.body]}
    parallel.on_root(lambda: _write(folder / name, surface.x, d - 1, surface.facets, data, of_cells))
    return [name]


def _write(
    path: Path,
    x: Array,
    dimension: int,
    cells: NDArray[np.int64],
    data: dict[str, Array],
    cell_data: dict[str, list[NDArray[np.int64]]],
) -> None:
    """Write a VTU file of cells of that dimension to a temporary name and rename it.

    Raises:
        SolveError: the disk refuses.
    """
    blocks = [(CELLS[dimension], cells[:, vtk_order(cells.shape[1], dimension)])]
    mesh = meshio.Mesh(in_space(x), blocks, point_data=data, cell_data=cell_data)
    temporary = path.with_name(f".{path.name}.partial")
    try:
        meshio.write(temporary, mesh, file_format="vtu")
        temporary.replace(path)
    except OSError as error:
        raise SolveError(f"cannot write {path}: {error.strerror}") from error
