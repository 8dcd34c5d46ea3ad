"""`min 1/2 |u - u*|_M^2  s.t.  b + J u >= 0` in a crowd, by an interior point method.

With slacks s of the rows, the conditions

    M (u - u*) = J^T p,     s = b + J u,     s_k p_k = mu,     s, p > 0

are followed to mu -> 0 by Mehrotra's predictor and corrector (SIAM J. Optim. 2 (1992) 575), two solves with
one sparse factor of `M + J^T diag(p/s) J` a step. The number of steps hardly depends on the number of bodies,
also where rows depend on each other. As mu -> 0 the factors lose digits, so the last ones are left to
`fsi.gluey.newton`.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu

from fsi.bodies import Array

STEPS = 40
# Of the square of the largest rate: where mu is small enough for Newton's method to find what touches.
CLOSE = 1e-10
# Of the way to the boundary s = 0 or p = 0 that a step may go.
WITHIN = 0.995
# Of the largest rate: gaps that are wider do not close.
FAR = 10.0


def approach(J: sp.csr_matrix, b: Array, mass: Array, u_star: Array, p: Array) -> Array:
    """Impulses p >= 0, (rows,), 0 where the gap is open; rows with far wider gaps are not looked at.

    Args:
        J: rows, (rows, modes).
        b: (rows,).
        mass: diagonal of M, > 0, (modes,).
        u_star: (modes,).
        p: impulses of the size that is sought, (rows,): in a crowd they add up, to far more than one body's.
    """
    rate = float(np.abs(J @ u_star).max(initial=0.0) + np.abs(J @ ((J.T @ p) / mass)).max(initial=0.0))
    near = np.flatnonzero(b <= FAR * rate)
    found = np.zeros(len(b))
    moved = np.unique(J[near].indices)  # what no row moves needs no solve
    if rate > 0.0 and len(near):
        found[near] = _follow(J[near][:, moved].tocsr(), b[near], mass[moved], u_star[moved], p[near], rate)
    return found


def _follow(J: sp.csr_matrix, b: Array, mass: Array, u_star: Array, p: Array, rate: float) -> Array:
    """The path to `mu = CLOSE rate^2`, with impulses in units that change the rate of their row by 1."""
    weight = J.multiply(J) @ (1.0 / mass)
    Jt, u = J.T.tocsr(), u_star
    s = np.maximum(b + J @ u, rate)
    p = max(rate, float((p * weight).max())) / weight
    for _ in range(STEPS):
        dual, primal = mass * (u - u_star) - Jt @ p, b + J @ u - s
        mu = float((s * weight * p).mean())
        if mu <= CLOSE * rate**2:
            break
        H = (sp.diags(mass) + Jt @ sp.diags(p / s) @ J).tocsc()
        try:
            lu = splu(H, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError:  # singular to rounding: mu is as small as it can be
            break
        direction = partial(_direction, lu, J, Jt, s, p, dual, primal)
        _, ds, dp = direction(-s * p)
        t = min(_longest(s, ds), _longest(p, dp))
        left = float(((s + t * ds) * weight * (p + t * dp)).mean()) / mu
        du, ds, dp = direction(left**3 * mu / weight - s * p - ds * dp)
        t = min(_longest(s, ds), _longest(p, dp))
        u, s, p = u + t * du, s + t * ds, p + t * dp
    closed: Array = np.where(p * weight > s, p, 0.0)
    return closed


def _direction(
    lu: SuperLU,
    J: sp.csr_matrix,
    Jt: sp.csr_matrix,
    s: Array,
    p: Array,
    dual: Array,
    primal: Array,
    product: Array,
) -> tuple[Array, Array, Array]:
    """The step (du, ds, dp) that changes s p by `product` and takes both residuals away, to first order."""
    du = lu.solve(-dual + Jt @ ((product - p * primal) / s))
    ds = J @ du + primal
    return du, ds, (product - p * ds) / s


def _longest(x: Array, dx: Array) -> float:
    """The largest step, at most 1, that keeps x > 0."""
    shrinks = dx < 0.0
    return min(1.0, WITHIN * float((x[shrinks] / -dx[shrinks]).min(initial=np.inf)))
