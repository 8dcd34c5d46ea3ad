"""Lattices by plain searches and by hand: nearest images, and what a mean flow makes of their vectors."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm

from fsi.meshes.geometry.lattice import Cell, Lattice, Vector


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
