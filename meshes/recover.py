"""The mesh of any step of a run, back from its field files.

The files hold the curved cells, of one rank each; the tags of the boundary follow from where bodies and
walls were.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import meshes.backend  # noqa: F401

import meshio
import numpy as np
from dolfinx import cpp
from dolfinx.mesh import CellType
from scipy.spatial import cKDTree

from meshes.curved import CurvedCells
from meshes.errors import MeshFileError
from meshes.geometry import Array, Container, boundary_distances
from meshes.triangulate import Indices

# Ranks share nodes to rounding; ends of a boundary edge lie on their body or wall nearly so.
SAME_NODE = 1e-13
ON_SURFACE = 1e-8


def recover(parts: Sequence[Path], container: Container, centres: Array, radii: Array) -> CurvedCells:
    """The cells in the field files of one step, with their boundary tagged as in `FluidMesh`.

    Args:
        parts: the VTU files of all ranks.
        container: what encloses the fluid.
        centres: q_i at that step, shape (N, 2).
        radii: a_i, shape (N,).

    Raises:
        MeshFileError: a file cannot be read, or its boundary is not that of these bodies and walls.
    """
    pieces, first = [], 0
    try:
        for part in parts:
            mesh = meshio.read(part)
            pieces.append(
                (mesh.points[:, :2], mesh.cells_dict["VTK_LAGRANGE_TRIANGLE"].astype(np.int64) + first)
            )
            first += len(mesh.points)
    except (OSError, meshio.ReadError, KeyError) as error:
        raise MeshFileError(f"{part}: cannot be read ({error}); mend the run with `fsi resume`") from None
    x, cells = (np.concatenate([piece[k] for piece in pieces]) for k in range(2))
    x, cells = _merged(x, cells, SAME_NODE * container.size())
    cells = cells[:, cpp.io.perm_vtk(CellType.triangle, cells.shape[1])]
    order = round((np.sqrt(8.0 * cells.shape[1] + 1.0) - 3.0) / 2.0)
    edges = _boundary_edges(cells[:, :3])
    return CurvedCells(x, cells, edges, _tags(x[edges], container, centres, radii), order)


def _merged(x: Array, cells: Indices, distance: float) -> tuple[Array, Indices]:
    """Nodes that coincide become one."""
    same = np.arange(len(x))
    pairs = cKDTree(x).query_pairs(distance, output_type="ndarray")
    np.minimum.at(same, pairs.max(axis=1), pairs.min(axis=1))
    kept, number = np.unique(same, return_inverse=True)
    return x[kept], number[cells]


def _boundary_edges(triangles: Indices) -> Indices:
    """Sides that belong to one triangle only, (E, 2)."""
    sides = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]), axis=1
    )
    unique, count = np.unique(sides, axis=0, return_counts=True)
    edges: Indices = unique[count == 1]
    return edges


def _tags(ends: Array, container: Container, centres: Array, radii: Array) -> Indices:
    """The body or wall that both ends of each edge (E, 2, 2) lie on."""
    tags = np.zeros(len(ends), dtype=np.int64)
    middles = cKDTree(ends.mean(axis=1))
    for i, (centre, radius) in enumerate(zip(centres, radii, strict=True)):
        near = np.array(middles.query_ball_point(centre, radius * (1.0 + ON_SURFACE)), dtype=np.intp)
        away = np.abs(np.hypot(*np.moveaxis(ends[near] - centre, 2, 0)) - radius).max(axis=1, initial=0.0)
        tags[near[away < ON_SURFACE * radius]] = i + 1
    to_walls = np.abs(np.stack([boundary_distances(container, ends[:, k]) for k in range(2)])).max(axis=0)
    wall = to_walls.argmin(axis=1)
    on_wall = (tags == 0) & (to_walls.min(axis=1) < ON_SURFACE * container.size())
    tags[on_wall] = len(radii) + 1 + wall[on_wall]
    if not tags.all():
        lost = ends[np.flatnonzero(tags == 0)[0]].mean(axis=0)
        raise MeshFileError(
            f"the boundary at ({lost[0]:.6g}, {lost[1]:.6g}) is on no body or wall; is it another run's file?"
        )
    return tags
