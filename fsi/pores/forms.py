"""The dissipation of the trial functions of pores, without their bubbles.

For psi with u = (psi_y, -psi_x) and viscosity 1

    2 e:e = 4 psi_xy^2 + (psi_yy - psi_xx)^2,   K = int of the products of these two numbers of two functions.

The bubbles of a pore meet no other; they are eliminated, which minimises the dissipation over them.
"""

from typing import NamedTuple

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.compiled import compiled
from fsi.pores.pore_data import pore_data
from fsi.pores.quadrature import Points, Rule, pore_points
from fsi.pores.regions import PoreShapes
from fsi.pores.steps import strain_rates
from fsi.pores.trial import Orders, trial_functions

# A bubble that others span to this part of its own dissipation, as rounding leaves it, is left out.
_DEPENDENT = 1e-14


class PoreForms(NamedTuple):
    """Of n pores.

    Attributes:
        K: dissipation of their shared functions, (n, m, m).
        area: of each, (n,).
        least: smallest weight of quadrature, (n,); not positive where a pore is no region.
    """

    K: Array
    area: Array
    least: Array


def pore_forms(shapes: PoreShapes, rule: Rule, orders: Orders) -> PoreForms:
    """The forms of pores of the same orders."""
    points = pore_points(shapes, rule)
    S, B = _strain_rates(shapes, points, orders)
    # Whatever X is, this is the dissipation of flows: positive, an upper bound, off by X's error squared.
    S = S - least_bubbles(S, B).transpose(0, 2, 1) @ B
    return PoreForms(S @ S.transpose(0, 2, 1), points.weight.sum(axis=1), points.weight.min(axis=1))


def with_bubbles(shapes: PoreShapes, rule: Rule, orders: Orders, x: Array) -> Array:
    """The numbers of all functions of pores, (n, total), from those of the shared ones, (n, shared)."""
    S, B = _strain_rates(shapes, pore_points(shapes, rule), orders)
    bubbles = -np.einsum("ebs,es->eb", least_bubbles(S, B), x)
    return np.concatenate([x, bubbles], axis=1)


def _strain_rates(shapes: PoreShapes, points: Points, orders: Orders) -> tuple[Array, Array]:
    """Strain rates times roots of weights, of shared functions and of bubbles, (n, ., 2 Q)."""
    rates = strain_rates(trial_functions(orders), pore_data(shapes), points)
    rows = rates.reshape(*rates.shape[:2], -1)
    return rows[:, : orders.shared], rows[:, orders.shared :]


def least_bubbles(S: Array, B: Array) -> Array:
    """X of the least |S - X^T B|^2, (n, bubbles, shared), of strain rates in rows, (n, ., 2 Q)."""
    G, X = B @ B.transpose(0, 2, 1), B @ S.transpose(0, 2, 1)
    own = np.sqrt(np.einsum("ebb->eb", G))[..., None]
    own[own == 0.0] = 1.0  # at the corner of a box
    G /= own * own.transpose(0, 2, 1)
    X /= own
    _solve(G, X, _DEPENDENT)
    X /= own
    return X


@compiled
def _solve(G: Array, X: Array, dependent: float) -> None:
    """X <- G^-1 X in place by L D L^T, (n, b, b) and (n, b, s), G of unit diagonal.

    The largest pivot goes first: else, where bubbles nearly depend on each other, small pivots would spread
    their rounding errors. What is left of dependent ones has no part in it.
    """
    m, s = X.shape[1], X.shape[2]
    order = np.empty(m, np.int64)
    for e in range(len(G)):
        A, Y = G[e], X[e]
        rank = m
        for k in range(m):
            p = k
            for i in range(k + 1, m):
                if A[i, i] > A[p, p]:
                    p = i
            if A[p, p] <= dependent:
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


@compiled
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
