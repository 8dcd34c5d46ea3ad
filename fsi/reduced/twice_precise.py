"""Sums and products in twice the precision of numbers, each kept as a number and what rounding took from it.

T. Ogita, S. M. Rump and S. Oishi, Accurate sum and dot product, SIAM J. Sci. Comput. 26 (2005) 1955:
algorithms 3.1 (Knuth), 3.3 (Dekker, Veltkamp) and 5.3, with errors eps |sum| + n^2 eps^2 sum |terms|.
"""

import numpy as np
import scipy.sparse as sp

from fsi.arrays import Array

_SPLIT = 2.0**27 + 1.0  # into two halves of 26 bits


def two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """a + b as rounded, and its error: both together are exact."""
    total = a + b
    of_b = total - a
    return total, (a - (total - of_b)) + (b - of_b)


def two_product(a: Array, b: Array) -> tuple[Array, Array]:
    """a b as rounded, and its error, exact up to 1e300."""
    product = a * b
    (high, low), (of_b, low_of_b) = _halves(a), _halves(b)
    return product, low * low_of_b - (((product - high * of_b) - low * of_b) - high * low_of_b)


def transposed_product(G: sp.csr_matrix, x: Array, x_low: Array) -> tuple[Array, Array]:
    """`G^T (x + x_low)` as a number and the rest, of G (R, M) and x (R,), shape (M,)."""
    columns = G.tocsc()
    count, starts = np.diff(columns.indptr), columns.indptr[:-1]
    total, rest = np.zeros(G.shape[1]), np.asarray(G.T @ x_low)
    for k in range(int(count.max(initial=0))):
        here = np.flatnonzero(count > k)
        entry = starts[here] + k
        term, error = two_product(columns.data[entry], x[columns.indices[entry]])
        total[here], lost = two_sum(total[here], term)
        rest[here] += lost + error
    return total, rest


def precise_gaps(start: Array, end: Array, shift: Array, a: Array, b: Array) -> Array:
    """`|start - end - shift| - a - b` of points (P, d), relatively precise where it is small.

    As `(s.s - c^2) / (|s| + c)` with the separation s and c = a + b.
    """
    s, low = two_sum(start, -end)
    s, lost = two_sum(s, -shift)
    low = low + lost
    c, of_c = two_sum(a, b)
    total, rest = two_product(c, -c)
    rest = rest - 2.0 * c * of_c
    for part, of_part in zip(s.T, low.T, strict=True):
        square, error = two_product(part, part)
        total, lost = two_sum(total, square)
        rest = rest + (lost + error + 2.0 * part * of_part)
    return np.asarray((total + rest) / (np.sqrt(np.einsum("pk,pk->p", s, s)) + c))


def _halves(a: Array) -> tuple[Array, Array]:
    scaled = _SPLIT * a
    high = scaled - (scaled - a)
    return high, a - high
