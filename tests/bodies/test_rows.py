"""Products with rows of pairs, of few rows and of many, against two products with dense matrices."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose

from fsi.bodies.rows import FEW, MANY, gram


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
    product, before = gram(sp.csr_matrix(J)), z.copy()
    for _ in range(2):
        assert_allclose(product(z), J @ (J.T @ z), rtol=0.0, atol=1e-11)
    assert_allclose(z, before, rtol=0.0, atol=0.0)


def test_rows_that_move_nothing() -> None:
    """All bodies held."""
    assert_allclose(gram(sp.csr_matrix((MANY + 1, 4)))(np.ones(MANY + 1)), 0.0)
