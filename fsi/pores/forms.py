"""The dissipation of the trial functions of pores, without their bubbles.

For psi with u = (psi_y, -psi_x) and viscosity 1

    2 e:e = 4 psi_xy^2 + (psi_yy - psi_xx)^2,   K = int of the products of these two numbers of two functions.

The bubbles of a pore meet no other; they are eliminated, which minimises the dissipation over them.
"""

from typing import NamedTuple

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.compiled import compiled
from fsi.pores.jets import strain
from fsi.pores.quadrature import Points, Rule, pore_points
from fsi.pores.regions import PoreShapes
from fsi.pores.trial import Orders, trial_functions

# A bubble that others span to this part of its own dissipation is left out.
_DEPENDENT = 1e-10


class Forms(NamedTuple):
    """Of n pores.

    Attributes:
        K: dissipation of their shared functions, (n, m, m).
        area: of each, (n,).
        least: smallest weight of quadrature, (n,); not positive where a pore is no region.
    """

    K: Array
    area: Array
    least: Array


def pore_forms(shapes: PoreShapes, rule: Rule, orders: Orders) -> Forms:
    """The forms of pores of the same orders."""
    points = pore_points(shapes, rule)
    S, B = _strain_rates(shapes, points, orders)
    # Whatever X is, this is the dissipation of flows: positive, an upper bound, off by X's error squared.
    S = S - least_bubbles(S, B).transpose(0, 2, 1) @ B
    return Forms(S @ S.transpose(0, 2, 1), points.weight.sum(axis=1), points.weight.min(axis=1))


def with_bubbles(shapes: PoreShapes, rule: Rule, orders: Orders, x: Array) -> Array:
    """The numbers of all functions of pores, (n, total), from those of the shared ones, (n, shared)."""
    S, B = _strain_rates(shapes, pore_points(shapes, rule), orders)
    bubbles = -np.einsum("ebs,es->eb", least_bubbles(S, B), x)
    return np.concatenate([x, bubbles], axis=1)


def _strain_rates(shapes: PoreShapes, points: Points, orders: Orders) -> tuple[Array, Array]:
    """Strain rates times roots of weights, of shared functions and of bubbles, (n, ., 2 Q)."""
    n, Q = points.weight.shape
    C = np.empty((orders.total, 2, n, Q))
    for row, function in zip(C, trial_functions(shapes, points, orders), strict=True):
        strain(function, row)
    C *= np.sqrt(np.abs(points.weight))
    rows = C.transpose(2, 0, 1, 3).reshape(n, orders.total, 2 * Q)
    return rows[:, : orders.shared], rows[:, orders.shared :]


def least_bubbles(S: Array, B: Array) -> Array:
    """X of the least |S - X^T B|^2, (n, bubbles, shared), of strain rates in rows, (n, ., 2 Q)."""
    G, X = B @ B.transpose(0, 2, 1), B @ S.transpose(0, 2, 1)
    _solve(G, X, _DEPENDENT)
    return X


@compiled
def _solve(G: Array, X: Array, dependent: float) -> None:
    """X <- G^-1 X in place by L D L^T, (n, b, b) and (n, b, s); dependent rows have no part in it."""
    m, s = X.shape[1], X.shape[2]
    for e in range(G.shape[0]):
        own = np.empty(m)
        for i in range(m):
            own[i] = G[e, i, i]
        for k in range(m):
            pivot = G[e, k, k]
            if pivot <= dependent * own[k]:
                G[e, k, k] = 0.0
                continue
            for i in range(k + 1, m):
                factor = G[e, i, k] / pivot
                for j in range(k + 1, i + 1):
                    G[e, i, j] -= factor * G[e, j, k]
                for c in range(s):
                    X[e, i, c] -= factor * X[e, k, c]
        for k in range(m - 1, -1, -1):
            pivot = G[e, k, k]
            for c in range(s):
                X[e, k, c] = 0.0 if pivot == 0.0 else X[e, k, c] / pivot
            if pivot == 0.0:
                continue
            for i in range(k + 1, m):
                factor = G[e, i, k] / pivot
                for c in range(s):
                    X[e, k, c] -= factor * X[e, i, c]
