"""Eight tetrahedra for each: a fine mesh is one of twice the sizes whose cells are parted.

gmsh takes longer for tetrahedra than all else that a mesh needs, and works on one rank. A cell of order 2
has a node in the middle of each edge, those on a round surface where that is. They are vertices of four
cells at its corners, and of an octahedron between these, which its shortest diagonal parts in four
(Bey 1995, Computing 55:355).

Middles then ease half way towards the mean of the vertices that edges join them to, each weighted by one
over its distance: forces err by a tenth less.
"""

from dataclasses import replace

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array, Indices
from fsi.meshes.cells.curved import CurvedCells, barycentric, reference_points
from fsi.meshes.geometry.container import lengths
from fsi.meshes.planar.triangulate import StraightCells, ascending, places_of, side_keys
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial.halved import EDGES

# Sizes of which cells twice as large still follow bodies and grow no faster than gmsh can make them.
FINE, SLOW = 32, 0.45

EASED = 0.5  # of the way to the mean of the neighbours
LEAST = 0.5  # of its volume: what no cell loses more of when middles are eased


def _middles() -> Indices:
    """The node of a cell of order 2 in the middle between two corners, (4, 4); the corner itself twice."""
    weights = np.rint(2.0 * barycentric(reference_points(2, 3))).astype(int)
    ends = [np.repeat(np.arange(4), row) for row in weights]
    middles = np.empty((4, 4), dtype=np.int64)
    for node, (i, j) in enumerate(ends):
        middles[[i, j], [j, i]] = node
    return middles


MIDDLE = _middles()
# Middles of opposite edges, which the diagonals of the octahedron join, (3, 2).
DIAGONALS = np.array([[MIDDLE[0, i], MIDDLE[j, k]] for i, j, k in ((1, 2, 3), (2, 3, 1), (3, 1, 2))])
# Around each of them the other four.
RINGS = np.array([[DIAGONALS[(k + step) % 3, side] for side in (0, 1) for step in (1, 2)] for k in range(3)])


def is_fine(resolution: Resolution) -> bool:
    """Whether cells of twice the sizes are fine enough to be parted."""
    return resolution.cells_per_circle >= FINE and resolution.growth <= SLOW


def twice(resolution: Resolution) -> Resolution:
    """Of cells that are twice as large everywhere."""
    return replace(
        resolution,
        cells_per_circle=resolution.cells_per_circle // 2,
        cells_per_gap=0.5 * resolution.cells_per_gap,
        growth=2.0 * resolution.growth,
    )


def refined(cells: CurvedCells) -> StraightCells:
    """The straight cells between the nodes of tetrahedra of order 2, and the facets between those of facets.

    Cells with a positive volume are parted into such, as long as none is nearly turned over by curving.
    """
    tets, x = cells.cells, cells.nodes
    corners = [tets[:, MIDDLE[k]] for k in range(4)]
    shortest = lengths(np.subtract(x[tets[:, DIAGONALS[:, 0]]], x[tets[:, DIAGONALS[:, 1]]]).reshape(-1, 3))
    chosen = shortest.reshape(-1, 3).argmin(axis=1)
    inner = []
    for k, (ends, ring) in enumerate(zip(DIAGONALS, RINGS, strict=True)):
        mine = tets[chosen == k]
        inner += [mine[:, [*ends, a, b]] for a, b in zip(ring, np.roll(ring, -1), strict=True)]
    facets, tags = _facets(cells)
    parts = StraightCells(x, np.concatenate([*corners, *inner]), facets, tags)
    return _eased(parts, int(tets[:, :4].max()) + 1)


def _facets(cells: CurvedCells) -> tuple[Indices, Indices]:
    """Four triangles for each facet, and their tags."""
    n, (i, j) = len(cells.nodes), EDGES.T
    keys, first = np.unique(side_keys(cells.cells[:, EDGES].reshape(-1, 2), n), return_index=True)
    middles = cells.cells[:, MIDDLE[i, j]].ravel()[first]
    a, b, c = cells.edges.T
    ab, bc, ca = (
        middles[places_of(side_keys(np.column_stack(ends), n), keys)[0]] for ends in ((a, b), (b, c), (c, a))
    )
    parts = ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))
    return np.concatenate([np.column_stack(part) for part in parts]), np.tile(cells.tags, len(parts))


def _eased(cells: StraightCells, first: int) -> StraightCells:
    """With the vertices from the first middle on, but for those on surfaces and sides, eased."""
    x, moves = cells.vertices, np.arange(len(cells.vertices)) >= first
    moves[cells.facets] = False
    before, goal = volumes(x, cells.cells), x + EASED * (_means(cells) - x)
    while True:
        eased = np.where(moves[:, None], goal, x)
        spoilt = volumes(eased, cells.cells) < LEAST * before
        back = moves & np.isin(np.arange(len(x)), cells.cells[spoilt])
        if not back.any():
            return StraightCells(eased, cells.cells, cells.facets, cells.tags)
        moves &= ~back


def _means(cells: StraightCells) -> Array:
    """Of the neighbours of each vertex, weighted by one over their distance."""
    x, n = cells.vertices, len(cells.vertices)
    # Each edge once, at its lower end, however many cells share it.
    low, high = (ends.ravel() for ends in ascending(np.moveaxis(cells.cells[:, EDGES], 2, 0)))
    half = scipy.sparse.csr_array((np.ones(len(low)), (low, high)), shape=(n, n))
    half.sum_duplicates()
    a, b = np.repeat(np.arange(n), np.diff(half.indptr)), half.indices
    half.data = 1.0 / lengths(x[a] - x[b])
    near = half + half.T
    means: Array = (near @ x) / near.sum(axis=1)[:, None]
    return means


def volumes(x: Array, tets: Indices) -> Array:
    """Of tetrahedra, negative where they are turned over, (T,)."""
    a, b, c, d = (x[tets[:, k]] for k in range(4))
    six: Array = np.einsum("td,td->t", np.cross(b - a, c - a), d - a)
    return six / 6.0
