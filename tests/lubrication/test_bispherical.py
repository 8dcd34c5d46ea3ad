"""Gauss's rule for sums against sums taken one by one."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from fsi.lubrication.bispherical import gram_rule, mode_rule


@pytest.mark.parametrize("length", [48.0, 96.0, 1536.0])
def test_exact_for_polynomials(length: float) -> None:
    """Up to degree 2 x 24 - 1; Gauss's rule for the INTEGRAL would be wrong by 2e-4 for x^2 on 48 points."""
    nodes, weights = gram_rule(length)
    points = np.arange(length) - 0.5 * (length - 1.0)
    scale = 0.5 * length
    for degree in (0, 2, 10, 30, 46):
        expected = np.sum((points / scale) ** degree)
        assert_allclose(weights @ (nodes / scale) ** degree, expected, rtol=1e-12)


@pytest.mark.parametrize("angle", [1.0, 0.1, 1e-3, 1e-5])
def test_sum_over_all_modes(angle: float) -> None:
    n, weights = mode_rule(angle)
    assert len(n) <= 48 + 24 * 16
    every = np.arange(1.0, np.ceil(30.0 / angle))

    def term(n: NDArray[np.float64]) -> NDArray[np.float64]:
        decaying: NDArray[np.float64] = np.exp(-(2.0 * n + 1.0) * angle) * n**3 / (4.0 * n**2 + 4.0 * n - 3.0)
        return decaying

    assert_allclose(weights @ term(n), np.sum(term(every)), rtol=1e-13)
