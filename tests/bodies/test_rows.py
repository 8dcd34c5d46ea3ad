"""Products with rows of pairs, of few rows and of many, against two products with dense matrices."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose

from fsi.arrays import Array
from fsi.bodies.rows import FEW, MANY, gram, products


@pytest.mark.parametrize("rows", [1, FEW, FEW + 1, MANY + 1])
@pytest.mark.parametrize("widest", [1, 4, 6])
def test_products_of_rows_and_their_transpose(rows: int, widest: int) -> None:
    """Rows with 0 to so many entries of 30 unknowns; twice, as sums begin anew; z is left as it is."""
    random = np.random.default_rng(0)
    J = np.zeros((rows, 30))
    for row in J:
        columns = random.choice(30, random.integers(widest + 1), replace=False)
        row[columns] = random.standard_normal(len(columns))
    z = random.standard_normal(rows)
    slack = random.uniform(size=rows)
    product, before = gram(sp.csr_matrix(J), slack), z.copy()
    for _ in range(2):
        assert_allclose(product(z), J @ (J.T @ z) + slack * z, rtol=0.0, atol=1e-11)
    assert_allclose(z, before, rtol=0.0, atol=0.0)


def test_rows_that_move_nothing() -> None:
    """All bodies held."""
    assert_allclose(gram(sp.csr_matrix((MANY + 1, 4)), np.full(MANY + 1, 2.0))(np.ones(MANY + 1)), 2.0)


def random_rows(rows: int) -> tuple[sp.csr_matrix, Array, Array]:
    """Rows with four entries of 30 unknowns, slack, and W = J J^T + diag(slack)."""
    random = np.random.default_rng(1)
    J = np.zeros((rows, 30))
    for row in J:
        row[random.choice(30, 4, replace=False)] = random.standard_normal(4)
    slack = random.uniform(0.5, 1.0, rows)
    return sp.csr_matrix(J), slack, J @ J.T + np.diag(slack)


def test_conjugate_gradients_against_a_dense_solution() -> None:
    """What is left after a few iterations is not handed out."""
    J, slack, W = random_rows(50)
    right = np.linspace(-1.0, 2.0, 50)
    found = products(J, slack).solve(right, 1e-13, 200)
    assert found is not None
    assert_allclose(found, np.linalg.solve(W, right), rtol=0.0, atol=1e-12)
    assert_allclose(np.linalg.norm(W @ found - right), 0.0, atol=2e-13 * np.linalg.norm(right))
    assert products(J, slack).solve(right, 1e-13, 5) is None
    none = products(J, slack).solve(np.zeros(50), 1e-13, 5)
    assert none is not None
    assert_allclose(none, 0.0, atol=0.0)


@pytest.mark.parametrize("uphill", [False, True])
def test_a_step_against_the_gradient(uphill: bool) -> None:
    """`z' = max(y - (W y + c), least)`; then `y' = z' + m (z' - z)`, or z' where (y - z').(z' - z) > 0."""
    J, slack, W = random_rows(40)
    c, least, y = np.linspace(-1.0, 1.0, 40), np.full(40, -0.1), np.linspace(0.0, 0.5, 40)
    expected = np.maximum(y - (W @ y + c), least)
    z = expected - (0.5 if uphill else -0.5) * (y - expected)
    following = y.copy()
    found, turned = products(J, slack).descend(c, least, following, z, 0.7)
    assert turned == uphill
    assert_allclose(found, expected, rtol=0.0, atol=1e-13)
    assert_allclose(following, expected + (0.0 if uphill else 0.7) * (expected - z), rtol=0.0, atol=1e-13)
