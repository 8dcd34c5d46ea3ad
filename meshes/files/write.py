"""Write the mesh of any step, through meshio.

A file has curved triangles and the tagged edges of bodies and walls, which have the fluid on their left; in
space curved tetrahedra and tagged triangles. In .msh files the tags are physical groups that bear the names
of the bodies and walls, as `fsi.meshes.files.read` wants them; in .vtu files they are the cell data `tag`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import fsi.meshes.backend  # noqa: F401

import dolfinx
import numpy as np
from dolfinx.mesh import CellType, entities_to_geometry
from mpi4py import MPI
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.files import appearing
from fsi.meshes.build import FluidMesh
from fsi.meshes.cells.curved import CurvedCells, barycentric, reference_points
from fsi.meshes.cells.lagrange import lattice, lattice_in_space
from fsi.meshes.errors import MeshFileError
from fsi.meshes.geometry.jets import cross
from fsi.meshes.planar.triangulate import places_of, side_keys

VTK_CELLS = {1: CellType.interval, 2: CellType.triangle, 3: CellType.tetrahedron}
if TYPE_CHECKING:
    import meshio

# Names that meshio gives to cells of order 1 ... 6, in space 1 ... 4, nodes in gmsh's order.
LINES = ("line", "line3", "line4", "line5", "line6", "line7")
TRIANGLES = ("triangle", "triangle6", "triangle10", "triangle15", "triangle21", "triangle28")
TETRAHEDRA = ("tetra", "tetra10", "tetra20", "tetra35")
SIMPLICES = (LINES, TRIANGLES, TETRAHEDRA)  # of dimension 1, 2, 3
# Corners of the edges and faces of gmsh's tetrahedron.
GMSH_SIDES = (((0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1)), ((0, 2, 1), (0, 1, 3), (0, 3, 2), (3, 1, 2)))
VTK_SIMPLICES = ("VTK_LAGRANGE_CURVE", "VTK_LAGRANGE_TRIANGLE", "VTK_LAGRANGE_TETRAHEDRON")


def write_mesh(fluid: FluidMesh, path: Path, names: Sequence[str]) -> None:
    """Write the mesh; collective, rank 0 writes.

    The path ends in .msh (gmsh 2.2) or .vtu, the names are those of the bodies. Raises MeshFileError where
    the suffix is unknown or the disk refuses.
    """
    require_suffix(path)
    cells, problem = gather(fluid), None
    if cells is not None:
        try:
            write_cells(cells, path, [*names, *fluid.container.boundary_names])
        except MeshFileError as error:
            problem = error
    problem = MPI.COMM_WORLD.bcast(problem)
    if problem is not None:
        raise problem


def require_suffix(path: Path) -> None:
    """Raises MeshFileError where `write_mesh` does not know the suffix."""
    if path.suffix not in FORMATS:
        raise MeshFileError(f"output = {path}: unknown suffix {path.suffix!r}; give {' or '.join(FORMATS)}")


def gather(fluid: FluidMesh) -> CurvedCells | None:
    """The whole mesh on rank 0, None elsewhere; collective."""
    mesh, tags, d = fluid.mesh, fluid.facet_tags, fluid.dimension
    geometry = mesh.geometry
    cells = geometry.dofmaps[0][: mesh.topology.index_map(d).size_local]
    owned = geometry.index_map().size_local
    numbers = geometry.index_map().local_to_global(np.arange(len(geometry.x), dtype=np.int32))
    edges = entities_to_geometry(mesh, d - 1, tags.indices)[:, :d]
    parts = MPI.COMM_WORLD.gather((geometry.x[:owned, :d], numbers[cells], numbers[edges], tags.values))
    if parts is None:
        return None
    x, all_cells, all_edges, values = (np.concatenate([part[k] for part in parts]) for k in range(4))
    return CurvedCells(x, all_cells, all_edges, values.astype(np.int64), fluid.order)


def write_cells(cells: CurvedCells, path: Path, names: Sequence[str]) -> None:
    """Write cells that are all here; where that fails nothing is left of the file.

    Path and errors are those of `write_mesh`; the names are those of the tags 1, 2, ...: bodies, then walls.
    """
    require_suffix(path)
    import meshio  # takes a tenth of a second to load

    file_format, convert = FORMATS[path.suffix]
    try:
        with appearing(path) as partial:
            meshio.write(partial, convert(cells, names), file_format=file_format)
    except OSError as error:
        why = error.strerror or f"the disk takes a part of it only ({error})"  # so NumPy says it
        raise MeshFileError(f"output = {path}: {why}; give another path") from error


def _gmsh_mesh(cells: CurvedCells, names: Sequence[str]) -> meshio.Mesh:
    """Cells and tagged facets in physical groups: the names, and `fluid`."""
    import meshio  # takes a tenth of a second to load

    d, order = cells.nodes.shape[1], cells.order
    # meshio takes this one kind in VTK's order and turns it itself.
    columns = vtk_order(10, 3) if (d, order) == (3, 2) else gmsh_order(order, d)
    inside, facets = cells.cells[:, columns], _facet_nodes(cells)
    if d == 3:
        facets = facets[:, gmsh_order(order, 2)]
    blocks = [(SIMPLICES[d - 1][order - 1], inside), (SIMPLICES[d - 2][order - 1], facets)]
    tags = _tags(cells, len(names))
    groups = {name: np.array([k + 1, d - 1]) for k, name in enumerate(names)}
    groups["fluid"] = np.array([len(names) + 1, d])
    cell_data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    return meshio.Mesh(_in_space(cells.nodes), blocks, cell_data=cell_data, field_data=groups)


def _vtu_mesh(cells: CurvedCells, names: Sequence[str]) -> meshio.Mesh:
    """Lagrange cells and facets with the cell data `tag`."""
    import meshio  # takes a tenth of a second to load

    d = cells.nodes.shape[1]
    inside, facets = cells.cells[:, vtk_order(cells.cells.shape[1], d)], _facet_nodes(cells)
    if d == 3:
        facets = facets[:, vtk_order(facets.shape[1], 2)]
    blocks = [(VTK_SIMPLICES[d - 1], inside), (VTK_SIMPLICES[d - 2], facets)]
    return meshio.Mesh(_in_space(cells.nodes), blocks, cell_data={"tag": _tags(cells, len(names))})


# What meshio calls the format of a suffix. Version 2.2 of gmsh's keeps the physical groups without a
# description of the geometry.
FORMATS: dict[str, tuple[str, Callable[[CurvedCells, Sequence[str]], meshio.Mesh]]] = {
    ".msh": ("gmsh22", _gmsh_mesh),
    ".vtu": ("vtu", _vtu_mesh),
}


def _in_space(x: Array) -> Array:
    """Points with three coordinates, z = 0 in the plane."""
    return np.column_stack([x, np.zeros((len(x), 3 - x.shape[1]))])


def _tags(cells: CurvedCells, groups: int) -> list[Indices]:
    """Tags of the cells, all the same, and of the facets."""
    return [np.full(len(cells.cells), groups + 1), cells.tags]


def vtk_order(nodes: int, dimension: int) -> NDArray[np.int64]:
    """Columns that put the nodes of simplices of that dimension from the order of basix into VTK's."""
    return np.argsort(dolfinx.cpp.io.perm_vtk(VTK_CELLS[dimension], nodes))


def gmsh_order(order: int, dimension: int) -> NDArray[np.int64]:
    """Columns that put the nodes of simplices from the order of basix into gmsh's (dolfinx knows up to 3)."""
    points = np.array(lattice(order) if dimension == 2 else lattice_in_space(order, *GMSH_SIDES)) / order
    return np.abs(points[:, None] - reference_points(order, dimension)).sum(axis=2).argmin(axis=1)


def _facet_nodes(cells: CurvedCells) -> Indices:
    """All nodes of the tagged facets in the order of basix, (F, nodes).

    Edges have their ends first, and the fluid on their left.
    """
    d = cells.nodes.shape[1]
    columns = facet_columns(cells.order, d)
    sides, n = cells.cells[:, columns].reshape(-1, columns.shape[1]), len(cells.nodes)
    at = places_of(side_keys(cells.edges, n), side_keys(sides[:, :d], n))[0]
    facets: Indices = sides[at]
    if d == 2:
        opposite = cells.cells[at // 3, at % 3]
        a, b, c = (cells.nodes[k] for k in (*facets[:, :2].T, opposite))
        right = cross(b - a, c - a) < 0.0
        facets[right] = facets[right][:, [1, 0, *range(cells.order, 1, -1)]]
    return facets


def facet_columns(order: int, dimension: int) -> Indices:
    """Columns of the nodes of each facet of a cell, in the order of basix, (facets, nodes)."""
    X = reference_points(order, dimension)
    corners = np.concatenate([np.zeros((1, dimension)), np.eye(dimension)])
    line = np.array([0.0, 1.0, *np.arange(1, order) / order])[:, None]
    weights = barycentric(line if dimension == 2 else reference_points(order))
    places = np.array([weights @ np.delete(corners, k, axis=0) for k in range(dimension + 1)])
    columns: Indices = np.abs(places[:, :, None] - X).sum(axis=3).argmin(axis=2)
    return columns
