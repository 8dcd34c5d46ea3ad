"""The numbers of the bubbles of one pore with which its flow costs least.

Loops in place of a library's: systems are so small that a library spends its time on their sizes.
"""

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.machine.compiled import internal, vectorised
from fsi.pores.products import products, squares, take_rows

# A bubble that others span to this part of its own dissipation, as rounding leaves it, is left out.
_DEPENDENT = 1e-14


@internal
def least_bubbles(S: Array, B: Array, end: int) -> Array:
    """X of the least |S - X^T B|^2, (bubbles, shared), of strain rates in rows, (., Q) up to an end."""
    G, X = np.empty((len(B), len(B))), np.empty((len(B), len(S)))
    own, order = np.empty(len(B)), np.empty(len(B), np.int64)
    squares(B, G, end)
    products(B, S, X, end)
    for b in range(len(B)):
        own[b] = np.sqrt(G[b, b]) if G[b, b] > 0.0 else 1.0  # 0 at the corner of a box
    for b in range(len(B)):
        for a in range(len(B)):
            G[b, a] /= own[b] * own[a]
        for c in range(len(S)):
            X[b, c] /= own[b]
    _solve(G, X, order, np.empty(len(B)))
    for b in range(len(B)):
        for c in range(len(S)):
            X[b, c] /= own[b]
    return X


@vectorised
def _solve(A: Array, Y: Array, order: NDArray[np.int64], f: Array) -> None:
    """Y <- A^-1 Y in place, (b, b) and (b, s), A of unit diagonal; room for the order and for factors, (b,).

    What is left of dependent rows has no part in it.
    """
    m, s = Y.shape
    rank = _factorise(A, order, f)
    for k in range(rank):
        _swap_rows(Y, k, order[k])
    for k in range(1, rank):
        for i in range(k):
            f[i] = A[i, k]
        take_rows(Y, k, f, (0, k), 0)
    for k in range(rank):
        for c in range(s):
            Y[k, c] /= A[k, k]
    for i in range(rank, m):
        for c in range(s):
            Y[i, c] = 0.0
    for k in range(rank - 2, -1, -1):
        take_rows(Y, k, A[k], (k + 1, rank), 0)
    for k in range(rank - 1, -1, -1):
        _swap_rows(Y, k, order[k])


@vectorised
def _factorise(A: Array, order: NDArray[np.int64], f: Array) -> int:
    """L D L^T = A: D on the diagonal, L^T above it; how many rows do not depend on those before.

    The largest pivot goes first: else, where bubbles nearly depend on each other, small pivots would spread
    their rounding errors.
    """
    m = len(A)
    for k in range(m):
        p = k
        for i in range(k + 1, m):
            if A[i, i] > A[p, p]:
                p = i
        if A[p, p] <= _DEPENDENT:
            return k
        order[k] = p
        _swap(A, k, p)
        for i in range(k):
            f[i] = A[i, i] * A[i, k]
        take_rows(A, k, f, (0, k), k + 1)
        for j in range(k + 1, m):
            A[k, j] /= A[k, k]
            A[j, j] -= A[k, k] * A[k, j] * A[k, j]
    return m


@vectorised
def _swap(A: Array, k: int, p: int) -> None:
    """Swap rows and columns k < p of what is above the diagonal, and of rows before k."""
    if k == p:
        return
    A[k, k], A[p, p] = A[p, p], A[k, k]
    for j in range(k + 1, p):
        A[k, j], A[j, p] = A[j, p], A[k, j]
    for j in range(p + 1, len(A)):
        A[k, j], A[p, j] = A[p, j], A[k, j]
    for j in range(k):
        A[j, k], A[j, p] = A[j, p], A[j, k]


@vectorised
def _swap_rows(Y: Array, k: int, p: int) -> None:
    """Swap rows k and p."""
    if k != p:
        for c in range(Y.shape[1]):
            Y[k, c], Y[p, c] = Y[p, c], Y[k, c]
