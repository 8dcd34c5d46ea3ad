"""Lattices by plain searches and by hand: nearest images, and what a mean flow makes of their vectors."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm

from fsi.meshes.geometry.cell import Cell, Vector
from fsi.meshes.geometry.lattice import Lattice


@pytest.mark.parametrize(
    "vectors", [((4.0, 0.0), (2.0, 3.0)), ((4.0, 0.0), (1.9, 4.0)), ((3.0, 0.0), (0.0, 5.0))]
)
def test_the_nearest_image_against_all_within_three_periods(vectors: tuple[tuple[float, float], ...]) -> None:
    """In an oblique cell rounding of coordinates gives another one near the corners."""
    lattice, random = Lattice(np.array(vectors)), np.random.default_rng(0)
    d = random.uniform(-9.0, 9.0, (300, 2))
    found = d - lattice.shift(lattice.nearest(d))
    every = np.array(list(product(range(-5, 6), repeat=2))) @ lattice.vectors
    shortest = np.linalg.norm(d[:, None] - every, axis=2).min(axis=1)
    assert_allclose(np.linalg.norm(found, axis=1), shortest, rtol=1e-12)


@pytest.mark.parametrize(
    "gradient", [((0.0, 2.0), (0.0, 0.0)), ((0.7, 0.0), (0.0, -0.7)), ((0.3, 1.0), (0.5, -0.3))]
)
def test_vectors_are_carried_by_the_exponential_of_the_gradient(
    gradient: tuple[Vector, Vector],
) -> None:
    """Of a shear it is 1 + E t: in time 0.5 at rate 2 a vector (0, 3) becomes (3, 3)."""
    cell = Cell(((4.0, 0.0), (0.0, 3.0)), gradient)
    e = np.array([[0.0, 3.0], [1.0, -2.0]])
    assert_allclose(cell.carried(e, 0.5), e @ expm(0.5 * np.array(gradient)).T, rtol=1e-13)
    if gradient == ((0.0, 2.0), (0.0, 0.0)):
        assert_allclose(cell.carried(e, 0.5)[0], [3.0, 3.0])


def test_a_cell_that_a_stress_strained_is_that_of_the_mean_flow_at_the_same_strain() -> None:
    """A shear at rate 2 over the time 0.3, and from there on with the rate that the stress gives by then."""
    vectors = ((4.0, 0.0), (1.0, 3.0))
    still, sheared = (Cell(vectors, ((0.0, rate), (0.0, 0.0))) for rate in (0.0, 2.0))
    e = np.array([[0.0, 3.0], [1.0, -2.0]])
    assert_allclose(still.at(0.3, strain=0.6).periods, sheared.at(0.3).periods, rtol=1e-14)
    assert_allclose(still.carried(e, 0.3, strain=0.6), sheared.carried(e, 0.3), rtol=1e-14)
    assert_allclose(
        still.at(0.3, strain=0.6).sheared(2.0).at(0.1).periods, sheared.at(0.4).periods, rtol=1e-14
    )
    assert_allclose(still.sheared(2.0).mean_gradient, sheared.mean_gradient)
    assert sheared.sheared(0.0) is sheared


def test_a_cell_of_space_is_strained_along_x_over_z() -> None:
    still = Cell(((4.0, 0.0, 0.0), (0.0, 5.0, 0.0), (0.0, 0.0, 3.0)), ((0.0,) * 3,) * 3)
    assert_allclose(still.carried(np.array([[0.0, 5.0, 3.0]]), 0.0, strain=0.5), [[1.5, 5.0, 3.0]])
