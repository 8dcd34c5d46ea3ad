"""The least dissipation of a pore over few bubbles, by products of all its functions.

A difference of products takes two thirds of the time of `elimination`, which forms the flows that are least.
Bubbles of a low degree depend little on each other, so that few digits cancel in it.
"""

import numpy as np

from fsi.bodies.configuration import Array
from fsi.machine.compiled import internal, vectorised
from fsi.pores.elimination import DEPENDENT, squares

FEW = 21  # bubbles, of degree 5


@internal
def least_of_few(rates: Array, K: Array) -> None:
    """The dissipation K of the shared functions, (m, m), least over the few bubbles behind them in rows.

    With the products A of all rows, (Q wide), of shared ones s and bubbles b, A_bb = L L^T and Z = L^-1 A_bs,
    it is K = A_ss - Z^T Z.
    """
    A, m = np.empty((len(rates), len(rates))), len(K)
    bubbles = len(A) - m
    G, Z, own = np.empty((bubbles, bubbles)), np.empty((bubbles, m)), np.empty(bubbles)
    squares(rates, A)
    for b in range(bubbles):
        own[b] = 1.0 / np.sqrt(A[m + b, m + b]) if A[m + b, m + b] > 0.0 else 1.0  # 0 at the corner of a box
    _scaled(A, own, G, Z)
    _take_squares(A, Z, _forward(G, Z), K)


@vectorised
def _scaled(A: Array, own: Array, G: Array, Z: Array) -> None:
    """The products of bubbles with each other and with shared functions, bubbles times `own`."""
    m = len(A) - len(G)
    for b in range(len(G)):
        row, of_bubbles, of_shared, factor = A[m + b], G[b], Z[b], own[b]
        for c in range(m):
            of_shared[c] = factor * row[c]
        for a in range(len(G)):
            of_bubbles[a] = factor * own[a] * row[m + a]


@vectorised
def _forward(G: Array, Z: Array) -> int:
    """Z <- L^-1 Z, G = L L^T of unit diagonal, the largest pivot first; how many are not dependent."""
    for k in range(len(G)):
        p = k
        for i in range(k + 1, len(G)):
            if G[i, i] > G[p, p]:
                p = i
        if G[p, p] <= DEPENDENT:
            return k
        for j in range(len(G)):
            G[k, j], G[p, j] = G[p, j], G[k, j]
        for j in range(len(G)):
            G[j, k], G[j, p] = G[j, p], G[j, k]
        for c in range(Z.shape[1]):
            Z[k, c], Z[p, c] = Z[p, c], Z[k, c]
        over = 1.0 / np.sqrt(G[k, k])
        pivot, own = G[k], Z[k]
        for j in range(k + 1, len(G)):
            pivot[j] *= over
        for c in range(len(own)):
            own[c] *= over
        for i in range(k + 1, len(G)):
            row, other, factor = G[i], Z[i], pivot[i]
            for j in range(k + 1, len(row)):
                row[j] -= factor * pivot[j]
            for c in range(len(own)):
                other[c] -= factor * own[c]
    return len(G)


@vectorised
def _take_squares(A: Array, Z: Array, rank: int, K: Array) -> None:
    """K = A_ss - Z^T Z, of the first rows of Z, four at a time."""
    m, whole = len(K), rank // 4 * 4
    for i in range(m):
        row, of_all = K[i], A[i]
        for j in range(m):
            row[j] = of_all[j]
    for b in range(0, whole, 4):
        z0, z1, z2, z3 = Z[b], Z[b + 1], Z[b + 2], Z[b + 3]
        for i in range(m):
            row, x0, x1, x2, x3 = K[i], z0[i], z1[i], z2[i], z3[i]
            for j in range(m):
                row[j] -= x0 * z0[j] + x1 * z1[j] + x2 * z2[j] + x3 * z3[j]
    for b in range(whole, rank):
        last = Z[b]
        for i in range(m):
            row, x0 = K[i], last[i]
            for j in range(m):
                row[j] -= x0 * last[j]
