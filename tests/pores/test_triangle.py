"""The points of thirds of a triangle integrate its polynomials."""

from math import factorial

import numpy as np
import pytest

from fsi.pores.levels import LEVELS
from fsi.pores.triangle import third


@pytest.mark.parametrize("degree", sorted({level.points[2] for level in LEVELS}))
def test_polynomials_are_integrated(degree: int) -> None:
    """int x^i y^j over the triangle (0, 0), (1, 0), (0, 1) is i! j! / (i + j + 2)!."""
    u, t, weight = third(degree)
    corners = np.eye(3)
    middle = corners.mean(axis=0)
    places = [
        middle + u[:, None] * ((1 - t)[:, None] * (corners[i] - middle) + t[:, None] * (corners[j] - middle))
        for i, j in ((1, 2), (2, 0), (0, 1))
    ]
    (x, y), w = np.concatenate(places)[:, :2].T, np.tile(weight, 3) / 3.0
    for i in range(degree + 1):
        for j in range(degree + 1 - i):
            exact = factorial(i) * factorial(j) / factorial(i + j + 2)
            # Digits of a weight that is off by 1e-12, or one point left out, would show.
            assert w @ (x**i * y**j) == pytest.approx(exact, rel=1e-12)
    assert np.all(weight > 0.0)
