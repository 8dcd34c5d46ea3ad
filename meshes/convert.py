"""Write the mesh of any step, through meshio.

A file has curved triangles and the tagged edges of bodies and walls. In .msh files the tags are physical
groups that bear the names of the bodies and walls, as `meshes.read` wants them; in .vtu files they are the
cell data `tag`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import meshes.backend  # noqa: F401

import meshio
import numpy as np
from dolfinx import cpp
from dolfinx.mesh import CellType, entities_to_geometry
from numpy.typing import NDArray

from meshes.build import FluidMesh
from meshes.curved import EDGES, CurvedCells, reference_points
from meshes.errors import MeshFileError
from meshes.geometry import Array
from meshes.triangulate import Indices

VTK_CELLS = {1: CellType.interval, 2: CellType.triangle, 3: CellType.tetrahedron}
# Names that meshio gives to triangles and edges of order 1 ... 4, nodes in gmsh's order.
TRIANGLES = ("triangle", "triangle6", "triangle10", "triangle15")
LINES = ("line", "line3", "line4", "line5")


def write_mesh(fluid: FluidMesh, path: Path, names: Sequence[str]) -> None:
    """Write the mesh; collective, rank 0 writes.

    Args:
        fluid: the mesh.
        path: .msh (gmsh 2.2) or .vtu.
        names: of the bodies.

    Raises:
        MeshFileError: unknown suffix, or the disk refuses.
    """
    require_suffix(path)
    cells, problem = gather(fluid), None
    if cells is not None:
        try:
            write_cells(cells, path, [*names, *fluid.boundary_names])
        except MeshFileError as error:
            problem = error
    problem = fluid.mesh.comm.bcast(problem)
    if problem is not None:
        raise problem


def require_suffix(path: Path) -> None:
    """The suffix must be one that `write_mesh` knows.

    Raises:
        MeshFileError: it is not.
    """
    if path.suffix not in FORMATS:
        raise MeshFileError(f"output = {path}: unknown suffix {path.suffix!r}; give {' or '.join(FORMATS)}")


def gather(fluid: FluidMesh) -> CurvedCells | None:
    """The whole mesh on rank 0, None elsewhere; collective."""
    mesh, tags = fluid.mesh, fluid.facet_tags
    geometry = mesh.geometry
    cells = geometry.dofmaps[0][: mesh.topology.index_map(2).size_local]
    owned = geometry.index_map().size_local
    numbers = geometry.index_map().local_to_global(np.arange(len(geometry.x), dtype=np.int32))
    edges = entities_to_geometry(mesh, 1, tags.indices)[:, :2]
    parts = mesh.comm.gather((geometry.x[:owned, :2], numbers[cells], numbers[edges], tags.values))
    if parts is None:
        return None
    x, all_cells, all_edges, values = (np.concatenate([part[k] for part in parts]) for k in range(4))
    return CurvedCells(x, all_cells, all_edges, values.astype(np.int64), fluid.order)


def write_cells(cells: CurvedCells, path: Path, names: Sequence[str]) -> None:
    """Write cells that are all here, to a temporary name that is then renamed.

    Args:
        cells: the mesh.
        path: .msh (gmsh 2.2) or .vtu.
        names: of the tags 1, 2, ...: bodies, then walls.

    Raises:
        MeshFileError: unknown suffix, or the disk refuses.
    """
    require_suffix(path)
    file_format, convert = FORMATS[path.suffix]
    temporary = path.with_name(f".partial-{path.name}")
    try:
        meshio.write(temporary, convert(cells, names), file_format=file_format)
        temporary.replace(path)
    except OSError as error:
        raise MeshFileError(f"output = {path}: {error.strerror}; give another path") from error


def _gmsh_mesh(cells: CurvedCells, names: Sequence[str]) -> meshio.Mesh:
    """Triangles and edges in physical groups: the names, and `fluid`."""
    triangles = cells.cells[:, gmsh_order(cells.order)]
    blocks = [(TRIANGLES[cells.order - 1], triangles), (LINES[cells.order - 1], _edge_nodes(cells))]
    tags = _tags(cells, len(names))
    groups = {name: np.array([k + 1, 1]) for k, name in enumerate(names)}
    groups["fluid"] = np.array([len(names) + 1, 2])
    cell_data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    return meshio.Mesh(_in_space(cells.nodes), blocks, cell_data=cell_data, field_data=groups)


def _vtu_mesh(cells: CurvedCells, names: Sequence[str]) -> meshio.Mesh:
    """Lagrange triangles and curves with the cell data `tag`."""
    triangles = cells.cells[:, vtk_order(cells.cells.shape[1])]
    blocks = [("VTK_LAGRANGE_TRIANGLE", triangles), ("VTK_LAGRANGE_CURVE", _edge_nodes(cells))]
    return meshio.Mesh(_in_space(cells.nodes), blocks, cell_data={"tag": _tags(cells, len(names))})


# What meshio calls the format of a suffix. Version 2.2 of gmsh's keeps the physical groups without a
# description of the geometry.
FORMATS: dict[str, tuple[str, Callable[[CurvedCells, Sequence[str]], meshio.Mesh]]] = {
    ".msh": ("gmsh22", _gmsh_mesh),
    ".vtu": ("vtu", _vtu_mesh),
}


def _in_space(x: Array) -> Array:
    """Points with z = 0."""
    return np.column_stack([x, np.zeros(len(x))])


def _tags(cells: CurvedCells, groups: int) -> list[Indices]:
    """Tags of the triangles, all the same, and of the edges."""
    return [np.full(len(cells.cells), groups + 1), cells.tags]


def vtk_order(nodes: int, dimension: int = 2) -> NDArray[np.int64]:
    """Columns that put the nodes of simplices of that dimension from the order of basix into VTK's."""
    return np.argsort(cpp.io.perm_vtk(VTK_CELLS[dimension], nodes))


def gmsh_order(order: int) -> NDArray[np.int64]:
    """Columns that put the nodes of triangles from the order of basix into gmsh's (dolfinx knows up to 3)."""
    points = np.array(_gmsh_lattice(order)) / order
    return np.abs(points[:, None] - reference_points(order)).sum(axis=2).argmin(axis=1)


def _gmsh_lattice(order: int) -> list[tuple[int, int]]:
    """Nodes in gmsh's order, in steps of 1 / order: vertices, sides 01, 12, 20, then the triangle inside."""
    if order <= 0:
        return [(0, 0)] if order == 0 else []
    along = range(1, order)
    sides = [(k, 0) for k in along] + [(order - k, k) for k in along] + [(0, order - k) for k in along]
    inside = [(i + 1, j + 1) for i, j in _gmsh_lattice(order - 3)]
    return [(0, 0), (order, 0), (0, order), *sides, *inside]


def _edge_nodes(cells: CurvedCells) -> Indices:
    """All nodes of the tagged edges, ends first, (E, order + 1)."""
    inner = cells.order - 1
    columns = [[i, j, *range(3 + e * inner, 3 + (e + 1) * inner)] for e, (i, j) in enumerate(EDGES)]
    sides = cells.cells[:, columns].reshape(-1, cells.order + 1)
    n = len(cells.nodes)
    keys = np.sort(sides[:, :2], axis=1) @ [n, 1]
    order = np.argsort(keys)
    wanted = np.sort(cells.edges, axis=1) @ [n, 1]
    edges: Indices = sides[order[np.searchsorted(keys[order], wanted)]]
    return edges
