"""The smallest gaps at any distance, against a plain search; and what counts as contact."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps, nearest_gaps, smallest_of_each, without_rounding
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.unbounded import Unbounded

BOX = Box((-20.0, -20.0), (20.0, 20.0))


def two_discs(distance: float) -> Configuration:
    return Configuration.unturned(np.array([[-0.5, 0.0], [0.5, 0.0]]) * distance, np.ones(2))


@pytest.mark.parametrize("gap", [1.9, 2.1, 4.0, 17.0, 300.0])
@pytest.mark.parametrize("container", [Unbounded(), Box((-200.0, -200.0), (200.0, 200.0))])
def test_two_discs_know_their_gap_at_any_distance(gap: float, container: Container) -> None:
    """A search of the reach of one diameter finds the wall in place of the disc, or nothing."""
    to_wall = 199.0 - 0.5 * (2.0 + gap) if container.walls else np.inf
    q = two_discs(2.0 + gap)
    assert nearest_gaps(q, container).smallest() == pytest.approx(min(gap, to_wall), rel=1e-14)
    np.testing.assert_allclose(smallest_of_each(q, container), min(gap, to_wall), rtol=1e-13)


def by_brute_force(q: Configuration, container: Container) -> Array:
    """The smallest gap of each body, of all images up to six periods off and all walls."""
    least = (container.distances(q.centres) - q.radii[:, None]).min(axis=1, initial=np.inf)
    for i, j in product(range(len(q)), repeat=2):
        for m in product(range(-6, 7), repeat=len(container.periods)):
            if i != j or any(m):
                away = np.array(m, dtype=float) @ container.periods if m else np.zeros(2)
                between = float(np.linalg.norm(q.centres[i] - q.centres[j] - away))
                least[i] = min(least[i], between - q.radii[i] - q.radii[j])
    return least


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    number=st.integers(1, 8),
    kind=st.sampled_from(["box", "unbounded", "strip", "cell"]),
    strain=st.floats(-1.0, 1.0),
)
def test_the_smallest_gap_of_each_body(seed: int, number: int, kind: str, strain: float) -> None:
    """Small bodies, most of which have no neighbour within a diameter, of radii that differ tenfold."""
    rng = np.random.default_rng(seed)
    container: Container = {
        "box": BOX,
        "unbounded": Unbounded(),
        "strip": Box((1.0, -20.0), (9.0, 20.0), periodic=("x",)),
        "cell": Cell(((8.0, 0.0), (0.0, 9.0)), ((0.0, 1.0), (0.0, 0.0)), strain),
    }[kind]
    centres = rng.uniform(-16.0, 16.0, (number, 2))
    q = Configuration.unturned(centres, 10.0 ** rng.uniform(-2.0, -1.0, number))
    expected = by_brute_force(q, container)
    np.testing.assert_allclose(smallest_of_each(q, container), expected, atol=1e-12)
    assert nearest_gaps(q, container).smallest() == pytest.approx(expected.min(), abs=1e-12)


def test_many_bodies_far_from_each_other_and_from_a_heap() -> None:
    """A hundred in a heap and three outliers: through the trees, against all pairs."""
    rng = np.random.default_rng(5)
    heap = 0.1 * np.stack(np.meshgrid(np.arange(10.0), np.arange(10.0)), axis=2).reshape(-1, 2)
    q = Configuration.unturned(np.vstack([heap, rng.uniform(5.0, 15.0, (3, 2))]), np.full(103, 0.04))
    every = find_gaps(q, BOX, reach=np.inf)
    assert len(every.pairs) == 103 * 102 / 2
    np.testing.assert_allclose(smallest_of_each(q, BOX), every.smallest_of_each(), rtol=1e-13)


def test_no_bodies_and_a_lone_one_have_no_gap_without_walls() -> None:
    nobody = Configuration.unturned(np.empty((0, 2)), np.empty(0))
    alone = Configuration.unturned(np.zeros((1, 2)), np.ones(1))
    for q in (nobody, alone):
        assert nearest_gaps(q, Unbounded()).smallest() == np.inf
        np.testing.assert_array_equal(smallest_of_each(q, Unbounded()), np.full(len(q), np.inf))


def test_contact_is_zero_and_all_else_stays() -> None:
    """Rounding of both signs and a solved overlap are contact; a positive gap and a real overlap are not."""
    gaps = np.array([-3.287e-16, 3e-16, -9e-11, 1.4e-11, 1e-3, -2e-10])
    np.testing.assert_array_equal(without_rounding(gaps, 1.0), [0.0, 0.0, 0.0, 1.4e-11, 1e-3, -2e-10])
