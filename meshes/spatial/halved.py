"""Halve the edges that lead through the fluid from surface to surface.

A velocity that is given at both ends of an edge is free only within it, and in a tetrahedron with four
vertices on surfaces hardly anywhere: gmsh makes many of these in gaps and beside walls. With a vertex in the
middle of each such edge the forces err by half to a third, on a tenth more unknowns, and the iterative solver
takes no more iterations where gmsh's cells are less regular.
"""

from dataclasses import replace
from itertools import combinations

import numpy as np

from fsi.arrays import Array, Indices
from fsi.meshes.geometry.container import lengths
from fsi.meshes.planar.triangulate import StraightCells, side_keys

EDGES = np.array(list(combinations(range(4), 2)))


def halved(cells: StraightCells, most: int) -> StraightCells:
    """The cells with a vertex in the middle of each edge between surfaces that is no edge of a facet.

    most: the highest tag of a surface, from 1 on; what is beyond, or 0, is open to the fluid behind it.
    """
    vertices, tets, on = cells.vertices, cells.cells, np.zeros(len(cells.vertices), dtype=bool)
    on[cells.facets[(cells.tags >= 1) & (cells.tags <= most)]] = True
    while len(between := _between(tets, on, cells.facets)):
        of_edge, ends = _edges(tets, between)
        first = _longest(lengths(np.subtract(*vertices[ends.T])), between // len(EDGES), of_edge)
        middles = np.zeros(len(ends), dtype=np.int64)
        chosen = np.unique(of_edge[first])
        middles[chosen] = len(vertices) + np.arange(len(chosen))
        vertices = np.concatenate([vertices, vertices[ends[chosen]].mean(axis=1)])
        on = np.append(on, np.zeros(len(chosen), dtype=bool))
        tets = _parted(tets, between[first], middles[of_edge[first]])
    return replace(cells, vertices=vertices, cells=tets)


def _between(tets: Indices, on: np.typing.NDArray[np.bool_], facets: Indices) -> Indices:
    """Which of the six edges of each cell lead from surface to surface through the fluid, flat."""
    n = len(on)
    both: Indices = np.flatnonzero(on[tets][:, EDGES].all(axis=2))
    keys = side_keys(tets[:, EDGES].reshape(-1, 2)[both], n)
    along = side_keys(facets[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), n)
    return both[~np.isin(keys, along)]


def _edges(tets: Indices, between: Indices) -> tuple[Indices, Indices]:
    """The number of the edge that each of them is, and the ends of the edges, (E, 2)."""
    ends, number = np.unique(
        np.sort(tets[:, EDGES].reshape(-1, 2)[between], axis=1), axis=0, return_inverse=True
    )
    return number, ends


def _longest(length: Array, cell: Indices, of_edge: Indices) -> Indices:
    """Where an edge is the longest of all in each of its cells: there no two are of one cell."""
    rank = np.argsort(np.argsort(length, kind="stable"))[of_edge]
    longest = np.zeros(int(cell.max()) + 1, dtype=np.int64)
    np.maximum.at(longest, cell, rank)
    beaten = np.unique(of_edge[rank < longest[cell]])
    return np.flatnonzero(~np.isin(of_edge, beaten))


def _parted(tets: Indices, edges: Indices, middles: Indices) -> Indices:
    """The cells, each with one of these edges as two with its middle in place of either end."""
    cell, (low, high) = edges // len(EDGES), EDGES[edges % len(EDGES)].T
    one, other = tets.copy(), tets[cell]
    one[cell, low] = middles
    other[np.arange(len(cell)), high] = middles
    return np.concatenate([one, other])
