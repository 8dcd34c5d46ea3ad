"""Meshes on disk, through meshio: write the mesh of any step, read a user's own gmsh mesh.

A file has curved triangles and the tagged edges of bodies and walls; in .msh files the tags are
physical groups that bear the names of the bodies and walls, and those are what `read_mesh` looks for.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import meshes.backend  # noqa: F401
import meshio
import numpy as np
from dolfinx import cpp
from dolfinx.mesh import CellType, entities_to_geometry
from mpi4py import MPI
from numpy.typing import NDArray

from meshes.build import FluidMesh, shared
from meshes.curved import EDGES, CurvedCells, curve
from meshes.errors import MeshError
from meshes.geometry import Array, Container, HalfPlane
from meshes.sizing import Curve
from meshes.triangulate import Indices

# Names that meshio gives to triangles and edges of order 1 ... 4, nodes in gmsh's order.
TRIANGLES = ("triangle", "triangle6", "triangle10", "triangle15")
ON_CIRCLE = 1e-3
LINES = ("line", "line3", "line4", "line5")


def write_mesh(fluid: FluidMesh, path: Path, names: Sequence[str]) -> None:
    """Write the mesh; collective, rank 0 writes.

    Args:
        fluid: the mesh.
        path: .msh (gmsh 4.1), .vtu, or whatever meshio writes.
        names: of the bodies.

    Raises:
        MeshError: meshio does not know the format, or the disk refuses.
    """
    cells, problem = gather(fluid), None
    if cells is not None:
        try:
            _write(cells, path, [*names, *fluid.walls])
        except (OSError, meshio.WriteError, KeyError) as error:
            problem = MeshError(f"cannot write {path}: {error}; give a folder that exists and a suffix such as .msh or .vtu")
    problem = fluid.mesh.comm.bcast(problem)
    if problem is not None:
        raise problem


def gather(fluid: FluidMesh) -> CurvedCells | None:
    """The whole mesh on rank 0, None elsewhere; collective."""
    mesh, tags = fluid.mesh, fluid.facet_tags
    geometry = mesh.geometry
    cells = geometry.dofmap[: mesh.topology.index_map(2).size_local]
    owned = geometry.index_map().size_local
    numbers = geometry.index_map().local_to_global(np.arange(len(geometry.x), dtype=np.int32))
    edges = entities_to_geometry(mesh, 1, tags.indices)[:, :2]
    parts = mesh.comm.gather((geometry.x[:owned, :2], numbers[cells], numbers[edges], tags.values))
    if parts is None:
        return None
    x, all_cells, all_edges, values = (np.concatenate([part[k] for part in parts]) for k in range(4))
    return CurvedCells(x, all_cells, all_edges, values.astype(np.int64), fluid.order)


def _write(cells: CurvedCells, path: Path, names: Sequence[str]) -> None:
    """Write gathered cells to a temporary name and rename it."""
    order, triangles = cells.order, cells.cells
    owner, edges = cells.tags, _edge_nodes(cells)
    tags = [np.full(len(triangles), len(names) + 1), owner]
    x = np.column_stack([cells.nodes, np.zeros(len(cells.nodes))])
    if path.suffix == ".vtu":
        blocks = [("VTK_LAGRANGE_TRIANGLE", triangles[:, vtk_order(triangles.shape[1])]), ("VTK_LAGRANGE_CURVE", edges)]
        mesh = meshio.Mesh(x, blocks, cell_data={"tag": tags})
    else:
        blocks = [(TRIANGLES[order - 1], triangles[:, _gmsh_order(triangles.shape[1])]), (LINES[order - 1], edges)]
        groups = {name: np.array([k + 1, 1]) for k, name in enumerate(names)}
        groups["fluid"] = np.array([len(names) + 1, 2])
        mesh = meshio.Mesh(x, blocks, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=groups)
    temporary = path.with_name(f".partial-{path.name}")
    # Version 2.2 of the format keeps the physical groups without a description of the geometry.
    meshio.write(temporary, mesh, file_format="gmsh22" if path.suffix == ".msh" else None)
    os.replace(temporary, path)


def vtk_order(nodes: int) -> NDArray[np.int64]:
    """Columns that put the nodes of triangles from the order of basix into VTK's."""
    return np.argsort(cpp.io.perm_vtk(CellType.triangle, nodes))


def _gmsh_order(nodes: int) -> NDArray[np.int64]:
    """Columns that put the nodes of triangles from the order of basix into gmsh's."""
    return np.argsort(cpp.io.perm_gmsh(CellType.triangle, nodes))


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


def read_mesh(
    path: Path, names: Sequence[str], container: Container, centres: Array, radii: Array, order: int,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> FluidMesh:  # fmt: skip
    """Read a gmsh mesh of the fluid around discs; collective.

    The file needs a physical curve for each body and wall, of its name. Straight triangles are curved to `order`
    along the discs (and the arc `far`); curved ones are taken as they are.

    Raises:
        MeshError: unreadable file, missing or misplaced group, untagged boundary, invalid cell (on all ranks).
    """
    return shared(lambda: _read(path, list(names), container, centres, radii, order), container, len(radii), comm)


def _read(path: Path, names: list[str], container: Container, centres: Array, radii: Array, order: int) -> CurvedCells:
    """The cells of a file, with tags in our numbers."""
    try:
        mesh = meshio.read(path)
    except (OSError, meshio.ReadError, KeyError, ValueError, SystemExit) as error:
        raise MeshError(f"domain.mesh = {path}: cannot be read ({error}); give a .msh file written by gmsh") from error
    kinds = [k for k, name in enumerate(TRIANGLES) if name in mesh.cells_dict]
    if len(kinds) != 1:
        raise MeshError(f"domain.mesh = {path}: has {len(kinds)} kinds of triangles; mesh the fluid with one, of order 1 to 4")
    own_order = kinds[0] + 1
    triangles = mesh.cells_dict[TRIANGLES[own_order - 1]].astype(np.int64)
    edges, tags = _tagged_edges(mesh, path, LINES[own_order - 1], [*names, *container.walls])
    used, numbers = np.unique(triangles, return_inverse=True)
    renumber = np.full(len(mesh.points), -1)
    renumber[used] = np.arange(len(used))
    triangles = numbers.reshape(triangles.shape)[:, cpp.io.perm_gmsh(CellType.triangle, triangles.shape[1])]
    nodes, edges = mesh.points[used, :2], renumber[edges]
    _require_boundary(path, triangles[:, :3], edges)
    circles = [Curve(i + 1, np.empty((0, 2)), closed=True, centre=centre) for i, centre in enumerate(centres)]
    for i, name in enumerate(names):
        ends = nodes[edges[tags == i + 1]].reshape(-1, 2)
        away = np.abs(np.hypot(*(ends - centres[i]).T) - radii[i]).max(initial=0.0)
        if away > ON_CIRCLE * radii[i]:
            raise MeshError(f"domain.mesh = {path}: group {name} lies up to {away:.3g} off its circle; correct the body or the mesh")
    if own_order > 1:
        return CurvedCells(nodes, triangles, edges, tags, own_order)
    if isinstance(container, HalfPlane):
        circles.append(Curve(len(names) + 2, np.empty((0, 2)), closed=False, centre=np.zeros(2)))
    return curve(nodes, triangles, edges, tags, circles, order)


def _tagged_edges(mesh: meshio.Mesh, path: Path, kind: str, names: list[str]) -> tuple[Indices, Indices]:
    """Ends of the edges in the physical groups of these names, and the place of each name + 1."""
    groups = mesh.field_data
    missing = [name for name in names if name not in groups]
    if missing:
        raise MeshError(f"domain.mesh = {path}: has no physical curve named {missing[0]}; it has {', '.join(groups) or 'none'}")
    edges = mesh.cells_dict.get(kind, np.empty((0, 2), dtype=int))[:, :2].astype(np.int64)
    physical = mesh.cell_data_dict["gmsh:physical"].get(kind, np.empty(0, dtype=int))
    tags = np.zeros(len(edges), dtype=np.int64)
    for k, name in enumerate(names):
        tags[physical == groups[name][0]] = k + 1
    return edges[tags > 0], tags[tags > 0]


def _require_boundary(path: Path, triangles: Indices, edges: Indices) -> None:
    """Every boundary edge must be tagged."""
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]), axis=1)
    found, count = np.unique(sides, axis=0, return_counts=True)
    boundary = {tuple(edge) for edge in found[count == 1].tolist()}
    tagged = {tuple(edge) for edge in np.sort(edges, axis=1).tolist()}
    if boundary != tagged:
        raise MeshError(
            f"domain.mesh = {path}: {len(boundary - tagged)} boundary edges are in no group and {len(tagged - boundary)}"
            " tagged edges are not on the boundary; tag exactly the bodies and walls"
        )
