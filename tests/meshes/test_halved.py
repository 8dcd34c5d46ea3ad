"""Edges between surfaces are halved: no cell knows its velocity from surfaces alone."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.planar.triangulate import StraightCells, require_boundary
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial.halved import EDGES, halved
from fsi.meshes.spatial.tetrahedra import fill


def block(n: int, m: int) -> StraightCells:
    """n x m x 1 cubes of six cells each around their diagonals; walls tagged 1 below, 2 above, 3 beside."""
    corners = [(i, j, k) for i in range(n + 1) for j in range(m + 1) for k in range(2)]
    number = {corner: at for at, corner in enumerate(corners)}
    ways = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
    cells = []
    for i, j in np.ndindex(n, m):
        for way in ways:
            path = np.cumsum([(i, j, 0), *np.eye(3, dtype=int)[list(way)]], axis=0)
            cells.append([number[tuple(corner)] for corner in path.tolist()])
    tets, x = np.array(cells), np.array(corners, dtype=float)
    sides = np.sort(np.concatenate([np.delete(tets, k, axis=1) for k in range(4)]), axis=1)
    facets, count = np.unique(sides, axis=0, return_counts=True)
    facets = facets[count == 1]
    height = x[facets][:, :, 2]
    tags = np.where((height == 0.0).all(axis=1), 1, np.where((height == 1.0).all(axis=1), 2, 3))
    return StraightCells(x, tets, facets, tags)


def volumes(cells: StraightCells) -> Array:
    x = cells.vertices[cells.cells]
    return np.asarray(np.abs(np.linalg.det(x[:, 1:] - x[:, :1])) / 6.0)


def between(cells: StraightCells, most: int) -> int:
    """How many edges that are no edges of facets have both ends on surfaces."""
    on = set(cells.facets[(cells.tags >= 1) & (cells.tags <= most)].ravel().tolist())
    along = {frozenset(pair) for facet in cells.facets.tolist() for pair in combinations(facet, 2)}
    edges = {frozenset(pair) for pair in cells.cells[:, EDGES].reshape(-1, 2).tolist()}
    return sum(edge <= on and edge not in along for edge in edges)


@given(st.integers(1, 4), st.integers(1, 4), st.integers(0, 5))
def test_no_edge_is_left_between_surfaces_and_the_cells_fill_what_they_filled(
    n: int, m: int, seed: int
) -> None:
    """In whatever order the cells come."""
    cells = block(n, m)
    cells = replace(cells, cells=np.random.default_rng(seed).permutation(cells.cells))
    assert between(cells, 3) == n * m + n * (m - 1) + m * (n - 1) + (n - 1) * (m - 1)
    parted = halved(cells, 3)
    assert between(parted, 3) == 0
    require_boundary(parted.cells, parted.facets)
    np.testing.assert_allclose(volumes(parted).sum(), n * m, rtol=1e-14)
    assert volumes(parted).min() > 1e-3
    np.testing.assert_array_equal(parted.vertices[: len(cells.vertices)], cells.vertices)


def test_what_is_open_is_no_surface() -> None:
    """Sides of periods and of layers, with tags beyond the last wall's or 0: the flow is free there."""
    cells, added = block(3, 3), []
    for above in (2, 4, 0):
        other = replace(cells, tags=np.where(cells.tags == 2, above, cells.tags))
        parted = halved(other, 3)
        assert between(parted, 3) == 0
        added.append(len(parted.vertices) - len(cells.vertices))
    assert added[1] == added[2] < added[0] == between(cells, 3)


def test_no_cell_of_a_mesh_around_spheres_has_all_its_corners_on_surfaces() -> None:
    """Two spheres beside each other in a box, whose gap is wide enough for gmsh's own cells."""
    domain = FluidDomain(
        Box((-3.0,) * 3, (3.0,) * 3), np.array([[-1.2, 0.0, 0.0], [1.2, 0.0, 0.0]]), np.ones(2)
    )
    cells = fill(domain, Resolution(0.5, 10, 0.6)).curved(2)
    on = np.zeros(len(cells.nodes), dtype=bool)
    on[cells.edges] = True  # the triangles on surfaces
    assert not on[cells.cells[:, :4]].all(axis=1).any()
