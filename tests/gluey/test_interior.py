"""Programs with gaps only: interior points and the polish against closed forms and another solver."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import isotonic_regression, lsq_linear

from fsi.bodies import Array
from fsi.gluey.interior import approach
from fsi.gluey.polish import polish
from fsi.gluey.response import Contact


def gaps_only(rows: int) -> Contact:
    return Contact(np.zeros(rows), np.zeros(0), rows, np.zeros(rows))


def polished(J: sp.csr_matrix, b: Array, mass: Array, u_star: Array) -> tuple[Array, float]:
    p = approach(J, b, mass, u_star, np.zeros(len(b)))
    return polish(J, b, mass, u_star, p, gaps_only(len(b)), 1e-12)


@pytest.mark.parametrize(("u", "expected"), [(-3.0, 4.0), (-1.0, 0.0), (1.0, 0.0)])
def test_one_body_above_a_wall(u: float, expected: float) -> None:
    """Mass 2, gap rate -1 allowed: p = max(0, -m (u + 1)) = 4 for u = -3; 0 if it does not arrive."""
    J, b, mass, u_star = sp.csr_matrix([[1.0]]), np.array([1.0]), np.array([2.0]), np.array([u])
    p = approach(J, b, mass, u_star, np.zeros(1))
    assert p[0] == pytest.approx(expected, abs=1e-4)  # near: mu is 1e-10 of the rates' square
    assert polished(J, b, mass, u_star)[0][0] == pytest.approx(expected, abs=1e-12)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.integers(2, 40))
def test_a_row_of_bodies_is_the_isotonic_regression(seed: int, n: int) -> None:
    """Touching bodies of any masses on a line: velocities are the isotonic ones of u*, weighted by mass."""
    random = np.random.default_rng(seed)
    mass, u_star = random.uniform(0.5, 2.0, n), random.normal(size=n)
    J = sp.diags([-np.ones(n - 1), np.ones(n - 1)], [0, 1], shape=(n - 1, n)).tocsr()
    p, residual = polished(J, np.zeros(n - 1), mass, u_star)
    assert residual <= 1e-10
    np.testing.assert_allclose(
        u_star + (J.T @ p) / mass, isotonic_regression(u_star, weights=mass).x, atol=1e-10
    )


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.booleans())
def test_velocities_are_those_of_a_bounded_least_squares_solver(seed: int, dependent: bool) -> None:
    """The dual is `min |M^-1/2 J^T p + M^1/2 u*|^2 / 2 + b.p`, p >= 0: scipy's bounded-variable solver.

    Rows that depend on each other leave p open, not u. As b = 0 here the dual is a least squares problem.
    """
    random = np.random.default_rng(seed)
    dense = random.normal(size=(12, 10)) * (random.uniform(size=(12, 10)) < 0.4)
    dense[:, 0] += 1.0
    if dependent:
        dense[6:9] = dense[:3] + dense[3:6]
    J, mass, u_star = sp.csr_matrix(dense), random.uniform(0.5, 2.0, 10), random.normal(size=10)
    p, residual = polished(J, np.zeros(12), mass, u_star)
    root = np.sqrt(mass)
    best = lsq_linear((dense / root).T, -root * u_star, (0.0, np.inf), method="bvls", tol=1e-14).x
    assert residual <= 1e-8
    np.testing.assert_allclose((J.T @ p) / mass, (dense.T @ best) / mass, atol=1e-7)


def test_a_polish_does_not_believe_a_wrong_guess() -> None:
    """Rows said to touch that must open: the impulses given come back, with their residual."""
    J = sp.csr_matrix(np.eye(2))
    guess = np.array([1.0, 0.0])
    p, residual = polish(J, np.zeros(2), np.ones(2), np.array([3.0, -1.0]), guess, gaps_only(2), 1e-12)
    assert residual >= 1.0 - 1e-9  # the second row needs p = 1
    assert np.all(p >= 0.0)
