"""Gaps across periodic sides against a plain search through many images."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.bodies import neighbours as searches
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps, pair_gaps
from fsi.bodies.neighbours import neighbours
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container

type Found = list[tuple[int, int, float, float, float]]


@contextmanager
def searched(*, by_trees: bool) -> Iterator[None]:
    """Few points are searched by trees, as many are, or as they are by default."""
    with pytest.MonkeyPatch.context() as patch:
        if by_trees:
            patch.setattr(searches, "_FEW", 0)
        yield


def by_brute_force(q: Configuration, container: Container, reach: float) -> Found:
    """(i, j, away, gap) for all images up to six periods off; a body and its own image once."""
    found, periods = [], container.periods
    for i, j in product(range(len(q)), repeat=2):
        for m in product(range(-6, 7), repeat=len(periods)):
            away = np.array(m) @ periods
            gap = float(np.hypot(*(q.centres[i] - q.centres[j] - away)) - q.radii[i] - q.radii[j])
            if gap <= reach and (i < j or (i == j and next((k for k in m if k), 0) > 0)):
                found.append((i, j, *away.tolist(), gap))
    return sorted(found)


@settings(max_examples=60)
@given(
    seed=st.integers(0, 10**6),
    number=st.integers(1, 6),
    strain=st.floats(-1.0, 1.0),
    cell=st.booleans(),
    by_trees=st.booleans(),
)
def test_all_near_pairs_and_no_others(
    seed: int, number: int, strain: float, cell: bool, by_trees: bool
) -> None:
    """Bodies lie up to two periods away from the cell; none may be missed or found twice."""
    rng = np.random.default_rng(seed)
    container: Container = Box((1.0, -4.0), (9.0, 4.0), periodic=("x",))
    if cell:
        container = Cell(((8.0, 0.0), (0.0, 9.0)), ((0.0, 1.0), (0.0, 0.0)), strain)
    centres = rng.uniform(-16.0, 16.0, (number, 2)) * ([1.0, 1.0] if cell else [1.0, 0.1])
    q = Configuration.unturned(centres, rng.uniform(0.1, 1.2, number))
    reach = 3.0
    with searched(by_trees=by_trees):
        gaps = find_gaps(q, container, reach)
    rows = zip(gaps.pairs.tolist(), gaps.away.tolist(), gaps.pair_gaps.tolist(), strict=True)
    found = sorted((i, j, *away, gap) for (i, j), away, gap in rows)
    expected = by_brute_force(q, container, reach)
    assert [row[:2] for row in found] == [row[:2] for row in expected]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    np.testing.assert_allclose(pair_gaps(q, gaps.pairs, gaps.away), gaps.pair_gaps, atol=0)


def test_images_are_carried_at_the_mean_velocity() -> None:
    """`carried` over a short time against E e, which is what gaps across the sides change by."""
    cell = Cell(((5.0, 0.0), (1.0, 4.0)), ((0.7, 0.0), (0.0, -0.7)))
    e, h = np.array([[5.0, 0.0], [1.0, -4.0]]), 1e-6
    slope = (cell.carried(e, h) - cell.carried(e, -h)) / (2.0 * h)
    np.testing.assert_allclose(cell.mean_velocity(e), slope, atol=1e-8)
    assert cell.mean_velocity(e)[0, 0] == pytest.approx(3.5)
    np.testing.assert_array_equal(
        Box((0.0, 0.0), (1.0, 1.0), periodic=("x",)).mean_velocity(e), np.zeros((2, 2))
    )


@settings(max_examples=30)
@given(
    seed=st.integers(0, 10**6),
    number=st.integers(0, 8),
    periodic=st.sets(st.sampled_from("xyz")),
    by_trees=st.booleans(),
)
def test_neighbours_in_boxes_that_are_periodic_in_any_directions(
    seed: int, number: int, periodic: set[str], by_trees: bool
) -> None:
    """Against all images up to five periods off, of points up to two periods outside; the cell is small."""
    container = Box((1.0, -2.0, 0.0), (3.0, 0.5, 3.0), periodic=tuple(sorted(periodic)))
    x = np.random.default_rng(seed).uniform(-2.0, 4.0, (number, 3))
    cutoff, periods = 2.6, container.periods
    with searched(by_trees=by_trees):
        pairs, m_near = neighbours(x, container, cutoff)
    expected = {}
    for i, j in product(range(number), repeat=2):
        for m in product(range(-5, 6), repeat=len(periods)):
            separation = x[i] - x[j] - np.array(m) @ periods if m else x[i] - x[j]
            first = i < j or (i == j and next((k for k in m if k), 0) > 0)
            if first and np.linalg.norm(separation) <= cutoff:
                expected[(i, j, *m)] = separation
    rows = np.column_stack([pairs, m_near]).tolist()
    assert len(rows) == len(expected)
    assert set(map(tuple, rows)) == set(expected)
    separations = x[pairs[:, 0]] - x[pairs[:, 1]] - m_near @ periods
    distances = pair_gaps(Configuration.unturned(x, np.zeros(number)), pairs, m_near @ periods)
    for row, separation, distance in zip(rows, separations, distances, strict=True):
        np.testing.assert_allclose(separation, expected[tuple(row)], atol=1e-12)
        assert distance == pytest.approx(np.linalg.norm(separation), rel=1e-14)


@pytest.mark.parametrize("number", [0, 1, 2, 64, 65])
def test_neighbours_in_a_closed_box_are_those_of_all_pairs(number: int) -> None:
    """Up to 64 points, and beyond, are searched in different ways."""
    x = np.random.default_rng(number).uniform(0.0, 3.0, (number, 3))
    pairs, m = neighbours(x, Box((0.0, 0.0, 0.0), (3.0, 3.0, 3.0)), 1.8)
    near = {(i, j) for i, j in combinations(range(number), 2) if np.linalg.norm(x[i] - x[j]) <= 1.8}
    assert set(map(tuple, pairs.tolist())) == near
    assert len(pairs) == len(near)
    assert m.shape == (len(near), 0)
    assert number < 64 or 0 < len(near) < number * (number - 1) // 2


def test_the_smallest_gap_of_each_body_is_that_to_either_side() -> None:
    """Three discs of radius 1 in a row in a wide box: gaps 0.3 and 0.7, for both that have them."""
    q = Configuration.unturned(np.array([[0.0, 0.0], [2.3, 0.0], [5.0, 0.0]]), np.ones(3))
    gaps = find_gaps(q, Box((-50.0, -50.0), (50.0, 50.0)), 2.0)
    np.testing.assert_allclose(gaps.smallest_of_each(), [0.3, 0.3, 0.7], rtol=1e-12)
