"""Sparse Cholesky factors against dense systems of the same matrices."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.errors import SolveError
from fsi.pores.definite import Cholesky


def form(n: int, seed: int) -> sp.csr_matrix:
    """A = B B^T + 1, sparse, of rows and columns whose units lie far apart."""
    rng = np.random.default_rng(seed)
    B = sp.random_array((n, n), density=0.2, rng=rng)
    units = sp.diags(10.0 ** rng.uniform(-6.0, 6.0, n))
    return sp.csr_matrix(units @ (B @ B.T + sp.eye(n)) @ units)


def triangle(K: sp.csr_matrix) -> sp.csr_matrix:
    """The lower one, columns in ascending order."""
    lower = sp.tril(K, format="csr")
    lower.sort_indices()
    return lower


@given(n=st.integers(2, 40), columns=st.integers(0, 3), seed=st.integers(0, 99))
def test_solutions_are_those_of_the_dense_system(n: int, columns: int, seed: int) -> None:
    """Of the free rows and columns, with a diagonal added."""
    rng, K = np.random.default_rng(seed), form(n, seed)
    free, D = rng.random(n) < 0.7, rng.random(n) * K.diagonal()
    free[0] = True
    A = K.toarray()[np.ix_(free, free)] + np.diag(D[free])
    units = np.sqrt(np.diag(A))
    x = rng.normal(size=(columns, len(A)) if columns else len(A)) / units
    factors = Cholesky(triangle(K), free, D)
    found = factors.solve(A @ x.T)
    assert found.shape == x.T.shape
    # The condition of B B^T + 1 is below 1e3; the lower triangle alone, or no scaling, would be off by 1.
    assert np.abs(units * (found.T - x)).max() <= 1e-12 * np.abs(units * x).max()
    assert factors.residual(A @ x.T - A @ found, A @ x.T) <= 1e-13


def solved(entries: list[list[float]], b: list[float]) -> Array:
    """By the factors of a small matrix."""
    A = sp.csr_matrix(np.array(entries))
    return Cholesky(triangle(A), np.ones(len(b), dtype=bool)).solve(np.array(b))


def test_a_pivot_that_rounding_made_negative_is_no_end_of_it() -> None:
    np.testing.assert_allclose(solved([[1.0, 2.0], [2.0, 1.0]], [3.0, 0.0]), [-1.0, 2.0], rtol=1e-14)


def test_what_is_singular_is_refused() -> None:
    with pytest.raises(SolveError, match="not positive"):
        solved([[1.0, 1.0], [1.0, 1.0]], [1.0, 1.0])
    with pytest.raises(SolveError, match="not determined"):
        solved([[1.0, 0.0], [0.0, 0.0]], [1.0, 1.0])
