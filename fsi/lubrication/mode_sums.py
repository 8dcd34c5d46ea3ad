"""Sums over all modes n = 1, 2, ... of a smooth, decaying series, with few terms at any gap.

The bispherical series of two spheres fall off like e^(-(2n+1) al), al ~ sqrt(2 q/a): at q/a = 1e-8 some 2e5
modes count. But a term hardly changes from one large n to the next, so the modes are taken in blocks
n .. 2n - 1 of doubling length, and each block is summed like an integral: by Gauss's rule for SUMS, whose
nodes are the zeros of Gram's polynomials (orthogonal over the integers 1 .. N, also called discrete Chebyshev
polynomials: G. Szego, "Orthogonal Polynomials", section 2.8). With 24 nodes a block the sum is exact to
rounding, and it costs 24 terms more each time the gap is four times smaller.
"""

from __future__ import annotations

from functools import cache
from math import ceil, log2

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh_tridiagonal

Array = NDArray[np.float64]

_FIRST = 48  # modes that are summed one by one
_NODES = 24  # of each later block
_DECAY = 45.0  # e^(-45), with the powers of n before it, is below the rounding of the sum


def mode_rule(angle: float) -> tuple[Array, Array]:
    """(n, w) such that sum_n f(n) = sum w f(n) for series that fall off like e^(-(2n+1) angle), angle > 0."""
    last = 0.5 * _DECAY / angle
    return _rule(max(0, ceil(log2(last / _FIRST))))


@cache
def _rule(blocks: int) -> tuple[Array, Array]:
    """Nodes and weights for 48 single modes and `blocks` blocks."""
    nodes, weights = [np.arange(1.0, _FIRST + 1.0)], [np.ones(_FIRST)]
    for k in range(blocks):
        length = _FIRST * 2.0**k
        x, w = gram_rule(length)
        nodes.append(1.5 * length + 0.5 + x)
        weights.append(w)
    return np.concatenate(nodes), np.concatenate(weights)


def gram_rule(length: float) -> tuple[Array, Array]:
    """Gauss's rule for the sum over `length` points one apart, centred at 0; exact up to degree 47.

    Nodes and weights are the eigenvalues of the Jacobi matrix of Gram's polynomials, and `length` times the
    squares of the first components of its eigenvectors (Golub and Welsch).
    """
    k = np.arange(1.0, _NODES)
    off_diagonal = 0.5 * k * np.sqrt((length**2 - k**2) / (4.0 * k**2 - 1.0))
    nodes, vectors = eigh_tridiagonal(np.zeros(_NODES), off_diagonal)
    return nodes, length * np.square(vectors[0])
