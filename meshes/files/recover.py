"""The mesh of any step of a run, back from its field files.

The files hold the curved cells, of one rank each; the tags of the boundary follow from where bodies and
walls were.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from math import comb
from pathlib import Path

import fsi.meshes.backend  # noqa: F401

import meshio
import numpy as np
from scipy.spatial import cKDTree

from fsi.meshes.cells.curved import CurvedCells
from fsi.meshes.errors import MeshFileError, at
from fsi.meshes.files.write import VTK_SIMPLICES, vtk_order
from fsi.meshes.geometry.containers import Array, FluidDomain
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.planar.triangulate import Indices, boundary_sides

# Ranks share nodes to rounding; ends of a boundary edge lie on their body or wall nearly so.
SAME_NODE = 1e-13
ON_SURFACE = 1e-8


def recover(parts: Sequence[Path], domain: FluidDomain) -> CurvedCells:
    """The cells in the field files of one step, with their boundary tagged as in `FluidMesh`.

    Args:
        parts: the VTU files of all ranks.
        domain: the container and the bodies at that step.

    Raises:
        MeshFileError: a file cannot be read, or its boundary is not that of these bodies and walls.
    """
    pieces, first, d = [], 0, domain.container.dimension
    try:
        for part in parts:
            mesh = meshio.read(part)
            simplices = mesh.cells_dict[VTK_SIMPLICES[d - 1]].astype(np.int64)
            pieces.append((mesh.points[:, :d], simplices + first))
            first += len(mesh.points)
    except (OSError, meshio.ReadError, KeyError) as error:
        raise MeshFileError(f"{part}: cannot be read ({error}); mend the run with `fsi resume`") from None
    x, cells = (np.concatenate([piece[k] for piece in pieces]) for k in range(2))
    x, cells = _merged(x, cells, SAME_NODE * domain.container.size())
    cells = cells[:, np.argsort(vtk_order(cells.shape[1], d))]
    order = next(k for k in range(1, cells.shape[1]) if comb(k + d, d) == cells.shape[1])
    edges = boundary_sides(cells[:, : d + 1])
    return CurvedCells(x, cells, edges, _tags(x[edges], domain), order)


def _merged(x: Array, cells: Indices, distance: float) -> tuple[Array, Indices]:
    """Nodes that coincide become one."""
    same = np.arange(len(x))
    pairs = cKDTree(x).query_pairs(distance, output_type="ndarray")
    np.minimum.at(same, pairs.max(axis=1), pairs.min(axis=1))
    distinct, number = np.unique(same, return_inverse=True)
    return x[distinct], number[cells]


def _tags(ends: Array, domain: FluidDomain) -> Indices:
    """The body or wall that all corners of each facet (E, d, d) lie on; the rest is the cut, if any."""
    container, radii = domain.container, domain.radii
    tags, lattice = np.zeros(len(ends), dtype=np.int64), Lattice(container.periods)
    centres = lattice.wrapped(domain.centres)
    home = lattice.wrapped(ends.mean(axis=1))
    ends = ends - (ends.mean(axis=1) - home)[:, None]
    middles = cKDTree(home)
    for i, m in product(range(len(radii)), lattice.near()):
        centre, radius = centres[i] + lattice.shift(m[None])[0], radii[i]
        near = np.array(middles.query_ball_point(centre, radius * (1.0 + ON_SURFACE)), dtype=np.intp)
        away = np.abs(np.hypot.reduce(ends[near] - centre, axis=2) - radius).max(axis=1, initial=0.0)
        tags[near[away < ON_SURFACE * radius]] = i + 1
    corners = np.moveaxis(ends, 1, 0)
    to_walls = np.abs(np.stack([container.boundary_distances(x) for x in corners])).max(axis=0)
    if to_walls.shape[1]:
        wall = to_walls.argmin(axis=1)
        on_wall = (tags == 0) & (to_walls.min(axis=1) < ON_SURFACE * container.size())
        tags[on_wall] = len(radii) + 1 + wall[on_wall]
    if lattice.dimension:
        tags[tags == 0] = len(radii) + 1 + len(container.walls)
    if not tags.all():
        lost = ends[np.flatnonzero(tags == 0)[0]].mean(axis=0)
        raise MeshFileError(f"the boundary at {at(lost)} is on no body or wall; is it another run's file?")
    return tags
