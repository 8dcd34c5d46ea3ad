"""Sums, products and gaps in twice the precision against rational arithmetic."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import scipy.sparse as sp

from fsi.reduced.twice_precise import precise_gaps, transposed_product, two_product, two_sum


def test_a_sum_and_a_product_are_exact_with_their_errors() -> None:
    random = np.random.default_rng(0)
    a, b = random.standard_normal((2, 100)) * 10.0 ** random.uniform(-12.0, 12.0, (2, 100))
    for x, y, total, lost, product, error in zip(a, b, *two_sum(a, b), *two_product(a, b), strict=True):
        assert Fraction(total) + Fraction(lost) == Fraction(x) + Fraction(y)
        assert Fraction(product) + Fraction(error) == Fraction(x) * Fraction(y)


def test_loads_that_cancel_are_summed_in_twice_the_precision() -> None:
    """Forces whose loads cancel to 1e-20 of them: in single precision nothing would be left."""
    random = np.random.default_rng(0)
    G = sp.csr_matrix(random.standard_normal((40, 4)) * (random.random((40, 4)) < 0.5))
    x, low = random.standard_normal(40), 1e-17 * random.standard_normal(40)
    # What a last row with the entry 1 in each column must have so that the columns nearly cancel.
    last = sp.csr_matrix(np.diag(-(G.T @ x)))
    rows = sp.csr_matrix(sp.vstack([G, last]))
    x, low = np.append(x, np.ones(4)), np.append(low, np.zeros(4))
    total, rest = transposed_product(rows, x, low)
    for column, high, more in zip(rows.toarray().T, total, rest, strict=True):
        right = sum(Fraction(g) * (Fraction(a) + Fraction(b)) for g, a, b in zip(column, x, low, strict=True))
        assert float(Fraction(high) + Fraction(more) - right) == pytest.approx(0.0, abs=1e-30)


@pytest.mark.parametrize("gap", [1e-4, 1e-8, 1e-12])
def test_gaps_of_oblique_pairs_are_precise(gap: float) -> None:
    """By the difference of the distance and the radii they are off by some 1e-16, 1e-4 of a gap of 1e-12."""
    random = np.random.default_rng(0)
    n, a, b = random.standard_normal((50, 2)), random.uniform(0.5, 2.0, 50), random.uniform(0.5, 2.0, 50)
    n /= np.linalg.norm(n, axis=1)[:, None]
    start, shift = random.uniform(-1.0, 1.0, (50, 2)), random.uniform(-5.0, 5.0, (50, 2))
    end = start - shift - (a + b + gap)[:, None] * n
    found = precise_gaps(start, end, shift, a, b)
    for k, D in enumerate(found):
        s = [
            Fraction(p) - Fraction(q) - Fraction(r)
            for p, q, r in zip(start[k], end[k], shift[k], strict=True)
        ]
        c = Fraction(a[k]) + Fraction(b[k])
        # D (D + 2 c) = s.s - c^2
        assert float(D) * float(Fraction(D) + 2 * c) == pytest.approx(
            float(s[0] ** 2 + s[1] ** 2 - c**2), rel=1e-14, abs=0.0
        )
