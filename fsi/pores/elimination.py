"""Products of the rows of strain rates of one pore, and the least of them over its bubbles.

Loops in place of a library's: products are so small that a library spends its time on their sizes, or on
threads.
"""

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.machine.compiled import internal, vectorised

# A bubble that others span to this part of its own dissipation, as rounding leaves it, is left out.
_DEPENDENT = 1e-14


@internal
def least_bubbles(S: Array, B: Array) -> Array:
    """X of the least |S - X^T B|^2, (bubbles, shared), of strain rates in rows, (., Q)."""
    G, X = np.empty((len(B), len(B))), np.empty((len(B), len(S)))
    own, order = np.empty(len(B)), np.empty(len(B), np.int64)
    squares(B, G)
    products(B, S, X)
    for b in range(len(B)):
        own[b] = np.sqrt(G[b, b]) if G[b, b] > 0.0 else 1.0  # 0 at the corner of a box
    for b in range(len(B)):
        for a in range(len(B)):
            G[b, a] /= own[b] * own[a]
        for c in range(len(S)):
            X[b, c] /= own[b]
    _solve(G, X, order)
    for b in range(len(B)):
        for c in range(len(S)):
            X[b, c] /= own[b]
    return X


@vectorised
def products(A: Array, B: Array, out: Array) -> None:
    """A B^T, two rows by four at a time; rows beyond the last are the last."""
    _products(A, B, out, 0)


@vectorised
def squares(A: Array, out: Array) -> None:
    """A A^T."""
    _products(A, A, out, 1)
    for i in range(len(A)):
        for j in range(i):
            out[i, j] = out[j, i]


@vectorised
def _products(A: Array, B: Array, out: Array, upper: int) -> None:
    """A B^T, or its upper triangle alone: four rows of B stay near while pairs of A go by."""
    m, n = len(A), len(B)
    for j in range(0, n, 4):
        j1, j2, j3 = min(j + 1, n - 1), min(j + 2, n - 1), min(j + 3, n - 1)
        c, d, e, f = B[j], B[j1], B[j2], B[j3]
        for i in range(0, min(m, j + 4) if upper else m, 2):
            k = min(i + 1, m - 1)
            a, b = A[i], A[k]
            ac = ad = ae = af = bc = bd = be = bf = 0.0
            for p in range(len(a)):
                ac += a[p] * c[p]
                ad += a[p] * d[p]
                ae += a[p] * e[p]
                af += a[p] * f[p]
                bc += b[p] * c[p]
                bd += b[p] * d[p]
                be += b[p] * e[p]
                bf += b[p] * f[p]
            out[i, j], out[i, j1], out[i, j2], out[i, j3] = ac, ad, ae, af
            out[k, j], out[k, j1], out[k, j2], out[k, j3] = bc, bd, be, bf


@vectorised
def take_off(S: Array, X: Array, B: Array) -> None:
    """S <- S - X^T B, two rows of S and four of B at a time; of an odd number the last is alone."""
    whole, pairs = len(B) // 4 * 4, len(S) // 2 * 2
    for c in range(0, pairs, 2):
        row, next_row = S[c], S[c + 1]
        for b in range(0, whole, 4):
            x0, x1, x2, x3 = X[b, c], X[b + 1, c], X[b + 2, c], X[b + 3, c]
            y0, y1, y2, y3 = X[b, c + 1], X[b + 1, c + 1], X[b + 2, c + 1], X[b + 3, c + 1]
            b0, b1, b2, b3 = B[b], B[b + 1], B[b + 2], B[b + 3]
            for p in range(len(row)):
                row[p] -= x0 * b0[p] + x1 * b1[p] + x2 * b2[p] + x3 * b3[p]
                next_row[p] -= y0 * b0[p] + y1 * b1[p] + y2 * b2[p] + y3 * b3[p]
        for b in range(whole, len(B)):
            last, x0, y0 = B[b], X[b, c], X[b, c + 1]
            for p in range(len(row)):
                row[p] -= x0 * last[p]
                next_row[p] -= y0 * last[p]
    for c in range(pairs, len(S)):
        row = S[c]
        for b in range(len(B)):
            last, x0 = B[b], X[b, c]
            for p in range(len(row)):
                row[p] -= x0 * last[p]


@vectorised
def _solve(A: Array, Y: Array, order: NDArray[np.int64]) -> None:
    """Y <- A^-1 Y in place by L D L^T, (b, b) and (b, s), A of unit diagonal; room for the order (b,).

    The largest pivot goes first: else, where bubbles nearly depend on each other, small pivots would spread
    their rounding errors. What is left of dependent ones has no part in it.
    """
    m, s = Y.shape
    rank = m
    for k in range(m):
        p = k
        for i in range(k + 1, m):
            if A[i, i] > A[p, p]:
                p = i
        if A[p, p] <= _DEPENDENT:
            rank = k
            break
        order[k] = p
        _swap(A, Y, k, p)
        for i in range(k + 1, m):
            factor = A[k, i] / A[k, k]
            for j in range(i, m):
                A[i, j] -= factor * A[k, j]
            for c in range(s):
                Y[i, c] -= factor * Y[k, c]
    for i in range(rank, m):
        for c in range(s):
            Y[i, c] = 0.0
    for k in range(rank - 1, -1, -1):
        for c in range(s):
            Y[k, c] /= A[k, k]
        for i in range(k + 1, rank):
            factor = A[k, i] / A[k, k]
            for c in range(s):
                Y[k, c] -= factor * Y[i, c]
    for k in range(rank - 1, -1, -1):
        for c in range(s):
            Y[k, c], Y[order[k], c] = Y[order[k], c], Y[k, c]


@vectorised
def _swap(A: Array, Y: Array, k: int, p: int) -> None:
    """Swap numbers k < p in what is left of A, the upper triangle, and the rows of Y."""
    if k == p:
        return
    A[k, k], A[p, p] = A[p, p], A[k, k]
    for j in range(k + 1, p):
        A[k, j], A[j, p] = A[j, p], A[k, j]
    for j in range(p + 1, len(A)):
        A[k, j], A[p, j] = A[p, j], A[k, j]
    for j in range(k):  # of rows that are done
        A[j, k], A[j, p] = A[j, p], A[j, k]
    for c in range(Y.shape[1]):
        Y[k, c], Y[p, c] = Y[p, c], Y[k, c]
