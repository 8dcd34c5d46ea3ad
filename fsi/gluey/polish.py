"""The last digits of `min 1/2 |u - u*|_M^2  s.t.  b + J u >= 0`, once it is known what touches.

The rows A that carry an impulse are closed, `b_A + J_A u = 0` with `u = u* + M^-1 J_A^T p_A`. A step of the
method of multipliers corrects p by what is left, `r = -(b_A + J_A u)`:

    (W_A + 1/sigma) dp = r,     W_A = J_A M^-1 J_A^T,     so     dp = sigma (r - J_A y),
    (M + sigma J_A^T J_A) y = sigma J_A^T r

with one sparse factor for all steps. As only r, which vanishes, is multiplied by sigma, and not u, rounding
costs no digits; and W_A may be singular, as where rows depend on each other.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fsi.bodies import Array
from fsi.gluey.response import Contact

STEPS = 20
# sigma in units of the mass that a row feels.
PENALTY = 1e6


def polish(
    J: sp.csr_matrix, b: Array, mass: Array, u_star: Array, p: Array, contact: Contact, tolerance: float
) -> tuple[Array, float]:
    """Impulses of the least residual, and that residual; those given, if what touches is not as they say.

    Args:
        J: rows, (rows, modes).
        b: (rows,).
        mass: diagonal of M, > 0, (modes,).
        u_star: (modes,).
        p: impulses, > 0 where rows touch, (rows,).
        contact: gaps only.
        tolerance: of the residual, a rate.
    """
    weight = J.multiply(J) @ (1.0 / mass)

    def rate(p: Array) -> Array:
        r: Array = b + J @ (u_star + (J.T @ p) / mass)
        return r

    r = rate(p)
    best, residual = p, contact.residual(r, p, weight)
    A = np.flatnonzero(p > 0.0)
    J_A, sigma = J[A], PENALTY / weight[A]
    H = (sp.diags(mass) + J_A.T @ sp.diags(sigma) @ J_A).tocsc()
    lu = splu(H, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    for _ in range(STEPS):
        if residual <= tolerance:
            break
        p = p.copy()
        p[A] -= sigma * (r[A] - J_A @ lu.solve(J_A.T @ (sigma * r[A])))
        p = contact.onto(p)
        r = rate(p)
        left = contact.residual(r, p, weight)
        if left >= residual:
            break
        best, residual = p, left
    return best, residual
