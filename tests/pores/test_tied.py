"""Forms with constraints against dense systems of the same matrices."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.pores.tied import LastFactors, TiedFactors, factors_of
from tests.pores.test_definite import form, triangle


@given(n=st.integers(6, 40), columns=st.integers(0, 3), seed=st.integers(0, 99))
def test_solutions_are_those_of_the_dense_system(n: int, columns: int, seed: int) -> None:
    """Of the free rows and columns, with a diagonal added; the last constraint is nearly the one before."""
    rng, K = np.random.default_rng(seed), form(n, seed)
    free, D = rng.random(n) < 0.9, rng.random(n) * K.diagonal()
    free[:4] = True
    units = np.sqrt(K.diagonal() + D)
    B = rng.normal(size=(3, n)) * units
    B[2] = B[1] + 1e-3 * B[2]
    own = K.toarray()[np.ix_(free, free)] + np.diag(D[free])
    A = np.block([[own, B[:, free].T], [B[:, free], np.zeros((3, 3))]])
    scale = np.append(units[free], np.ones(3))  # of the unknowns 1/units and 1
    x = rng.normal(size=(columns, len(A)) if columns else len(A)) / scale
    factors = TiedFactors(triangle(K), free, D, sp.csr_matrix(B))
    found = factors.solve(A @ x.T)
    found += factors.solve(A @ x.T - A @ found)
    assert found.shape == x.T.shape
    # One constraint left out, or kappa in place of the limit, would be off by order 1, or by 1e-4 and more.
    assert np.abs(scale * (found.T - x)).max(initial=0.0) <= 1e-8 * np.abs(scale * x).max(initial=0.0)
    assert factors.residual(A @ x.T - A @ found, A @ x.T) <= 1e-12


def test_numbers_that_are_known_to_their_own_digits_are_found_to_them() -> None:
    """A flux q = c_2 - c_1 of 1e-12 through a neck of stiffness 1e12 takes the pressure 1.

    Its stiffness times the difference of both would know it to 1e-4.
    """
    soft, stiff = 1.0, 1e12
    K = sp.csr_matrix(np.diag([soft, soft, stiff]))
    B = sp.csr_matrix([[1.0, -1.0, 1.0]])  # q + c_1 - c_2 = 0
    load = np.array([2.0, 0.0, 0.0, 0.0])  # pushes c_1 alone
    c_1, c_2, q, p = factors_of(K, np.ones(3, dtype=bool), np.zeros(3), B).solve(load)
    assert p == pytest.approx(1.0, rel=1e-8)
    assert q == pytest.approx(-1e-12, rel=1e-8)
    assert [c_1, c_2] == pytest.approx([1.0, 1.0], rel=1e-8)


def test_factors_are_kept_for_the_same_numbers_and_diagonal_alone() -> None:
    """Each solves its own system: those of another would be off by a half or more."""
    K, b, no_ties = sp.csr_matrix(np.diag([2.0, 4.0])), np.ones(2), sp.csr_matrix((0, 2))
    last, free, none = LastFactors(), np.ones(2, dtype=bool), np.zeros(2)

    def solved(free: NDArray[np.bool_], D: Array) -> Array:
        return last.of(K, free, D, no_ties).solve(b[: free.sum()])

    first = last.of(K, free, none, no_ties)
    assert last.of(K, free.copy(), none.copy(), no_ties) is first
    np.testing.assert_allclose(solved(free, np.full(2, 2.0)), [1.0 / 4.0, 1.0 / 6.0], rtol=1e-15)
    np.testing.assert_allclose(solved(np.array([False, True]), none), [1.0 / 4.0], rtol=1e-15)
    again = last.of(K, free, none, no_ties)
    assert again is not first
    last.forget()
    assert last.of(K, free, none, no_ties) is not again
