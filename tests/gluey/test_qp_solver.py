"""Programs with gaps only: interior points, then Newton, against closed forms and another solver."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import isotonic_regression, lsq_linear

from bench.gluey import H, crowd
from fsi.arrays import Array
from fsi.gluey import qp_solver
from fsi.gluey.augmented_lagrangian import Impulses, Program, minimise
from fsi.gluey.interior_points import by_interior_points
from fsi.gluey.qp_solver import ContactResponse
from fsi.gluey.step import advance


def solved(program: Program) -> Impulses:
    rows = len(program.b)
    return minimise(program, by_interior_points(program), ContactResponse.of_gaps(rows), 1e-13)


@pytest.mark.parametrize(("u", "expected"), [(-3.0, 4.0), (-1.0, 0.0), (1.0, 0.0)])
def test_one_body_above_a_wall(u: float, expected: float) -> None:
    """Mass 2, gap rate -1 allowed: p = max(0, -m (u + 1)) = 4 for u = -3; 0 if it does not arrive."""
    program = Program(sp.csr_matrix([[1.0]]), np.array([1.0]), np.array([2.0]), np.array([u]))
    p = by_interior_points(program)
    assert p[0] == pytest.approx(expected, abs=1e-4)  # near: to 1e-10 of the rate
    assert solved(program).p[0] == pytest.approx(expected, abs=1e-12)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.integers(2, 40))
def test_a_row_of_bodies_is_the_isotonic_regression(seed: int, n: int) -> None:
    """Touching bodies of any masses on a line: velocities are the isotonic ones of u*, weighted by mass."""
    random = np.random.default_rng(seed)
    mass, u_star = random.uniform(0.5, 2.0, n), random.normal(size=n)
    J = sp.diags([-np.ones(n - 1), np.ones(n - 1)], [0, 1], shape=(n - 1, n)).tocsr()
    found = solved(Program(J, np.zeros(n - 1), mass, u_star))
    assert found.kkt <= 1e-10
    np.testing.assert_allclose(found.u, isotonic_regression(u_star, weights=mass).x, atol=1e-10)


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
    found = solved(Program(J, np.zeros(12), mass, u_star))
    root = np.sqrt(mass)
    best = lsq_linear((dense / root).T, -root * u_star, (0.0, np.inf), method="bvls", tol=1e-14).x
    assert found.kkt <= 1e-10
    np.testing.assert_allclose(found.u, u_star + (dense.T @ best) / mass, atol=1e-7)


@pytest.mark.parametrize("lean", [1e-3, 1e-4])
def test_contacts_that_all_but_hold_each_other_keep_all_digits(lean: float) -> None:
    """Two walls that lean by `lean` hold a body between them: `J M^-1 J^T` has the eigenvalue lean^2.

    Rows (lean, +-1), u* = (-lean, 0), b = 0: both close, so u = 0 and p = (1/2, 1/2) by symmetry. With a
    penalty of 1e6 twenty-five outer steps would leave half of the error of p at 1e-4.
    """
    program = Program(
        sp.csr_matrix([[lean, 1.0], [lean, -1.0]]), np.zeros(2), np.ones(2), np.array([-lean, 0.0])
    )
    found = minimise(program, np.array([0.7, 0.4]), ContactResponse.of_gaps(2), 1e-16)
    np.testing.assert_allclose(found.p, 0.5, rtol=1e-4)
    np.testing.assert_allclose(found.u, 0.0, atol=1e-4 * lean)


def test_newton_does_not_believe_a_wrong_guess() -> None:
    """Rows said to touch that must open, and open ones that must touch: u* = (3, -1) gives p = (0, 1)."""
    program = Program(sp.csr_matrix(np.eye(2)), np.zeros(2), np.ones(2), np.array([3.0, -1.0]))
    found = minimise(program, np.array([1.0, 0.0]), ContactResponse.of_gaps(2), 1e-12)
    np.testing.assert_allclose(found.p, [0.0, 1.0], atol=1e-12)


def test_a_squeezed_crowd_is_the_same_bit_by_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Interior points begin afresh, so that a resumed run goes on as an unbroken one."""
    asked: list[Program] = []

    def counted(program: Program) -> Array:
        asked.append(program)
        return by_interior_points(program)

    monkeypatch.setattr(qp_solver, "by_interior_points", counted)
    system, begin = crowd(1000, "squeezed")
    (one, touching, checks), (other, again, _) = (advance(system, begin, 0.0, H) for _ in range(2))
    assert len(asked) == 2
    assert checks.kkt <= 1e-9
    np.testing.assert_array_equal(one.U, other.U)
    np.testing.assert_array_equal(one.gamma, other.gamma)
    np.testing.assert_array_equal(touching.p, again.p)
