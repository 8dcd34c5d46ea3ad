"""Sparse Cholesky factors against dense systems of the same matrices."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given
from hypothesis import strategies as st

from fsi.errors import SolveError
from fsi.pores.definite import solve_definite


def form(n: int, seed: int) -> sp.csr_matrix:
    """A = B B^T + 1, sparse, of rows and columns whose units lie far apart."""
    rng = np.random.default_rng(seed)
    B = sp.random_array((n, n), density=0.2, rng=rng)
    units = sp.diags(10.0 ** rng.uniform(-6.0, 6.0, n))
    A = sp.csr_matrix(units @ (B @ B.T + sp.eye(n)) @ units)
    A.sort_indices()
    return A


@given(n=st.integers(1, 40), columns=st.integers(0, 3), seed=st.integers(0, 99))
def test_solutions_are_those_of_the_dense_system(n: int, columns: int, seed: int) -> None:
    A = form(n, seed)
    x = np.random.default_rng(seed).normal(size=(n, columns) if columns else n) / np.sqrt(A.diagonal())[0]
    found, residual = solve_definite(A, A @ x)
    units = np.sqrt(A.diagonal()).reshape(n, *[1] * (x.ndim - 1))
    assert found.shape == x.shape
    # The condition of B B^T + 1 is below 1e3; the lower triangle alone, or no scaling, would be off by 1.
    assert np.abs(units * (found - x)).max() <= 1e-12 * np.abs(units * x).max()
    assert residual <= 1e-13


def test_a_pivot_that_rounding_made_negative_is_no_end_of_it() -> None:
    x, residual = solve_definite(sp.csr_matrix([[1.0, 2.0], [2.0, 1.0]]), np.array([3.0, 0.0]))
    np.testing.assert_allclose(x, [-1.0, 2.0], rtol=1e-14)
    assert residual <= 1e-15


def test_what_is_singular_is_refused() -> None:
    with pytest.raises(SolveError, match="not positive"):
        solve_definite(sp.csr_matrix([[1.0, 1.0], [1.0, 1.0]]), np.ones(2))
    with pytest.raises(SolveError, match="not determined"):
        solve_definite(sp.csr_matrix([[1.0, 0.0], [0.0, 0.0]]), np.ones(2))
