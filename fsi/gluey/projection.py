"""`min 1/2 |u - u*|_M^2  s.t.  b + J u >= 0`: the velocity nearest to u* that lets no gap become negative.

Its dual, over the set K of impulses p that are allowed (p >= 0; `fsi.gluey.response` adds friction and
films), is

    min_{p in K}  1/2 p.W p + c.p,      W = J M^-1 J^T + diag(compliance),   c = b + J u*,      u = u* +
    M^-1 J^T p.

It is solved by the projected gradient with momentum, which begins anew whenever it points uphill: Y.
Nesterov,
Dokl. Akad. Nauk SSSR 269 (1983) 543; B. O'Donoghue & E. Candes, Found. Comput. Math. 15 (2015) 715, for rows
scaled to the unit diagonal. That is quick where few bodies touch. In a crowd, where information must travel
through all of it, Newton's method (`fsi.gluey.newton`) goes on; where there are only gaps an interior point
method (`fsi.gluey.interior`) brings it near to what touches, and `fsi.gluey.polish` finds the last digits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, eigsh

from fsi.bodies import Array
from fsi.gluey.interior import approach
from fsi.gluey.newton import minimise
from fsi.gluey.polish import polish
from fsi.gluey.response import Contact

CHECK_EVERY = 10
# Of the tolerance: the residual at which Newton's method knows what touches.
ROUGHLY = 100.0
# The gradient goes on for as long as each so many iterations halve the least residual, but no longer than:
PATIENCE, MOST_ITERATIONS = 1000, 5000


@dataclass(frozen=True, slots=True)
class Impulses:
    """The solution of the dual.

    p: impulses, shape (rows,); u: velocities, (modes,); kkt: the largest natural residual
    `|p - P_K(p - (W p + c) / W_ii)| W_ii`, a rate of a gap; iterations: of the gradient; steps: of Newton's
    method.
    """

    p: Array
    u: Array
    kkt: float
    iterations: int
    steps: int


def project(
    J: sp.csr_matrix, b: Array, mass: Array, u_star: Array, p: Array, contact: Contact, tolerance: float
) -> Impulses:
    """Solve the dual.

    Args:
        J: rows, (rows, modes).
        b: (rows,).
        mass: diagonal of M, > 0, (modes,).
        u_star: (modes,).
        p: where to begin, (rows,).
        contact: which impulses are allowed, and compliances.
        tolerance: of `kkt`, a velocity.

    Returns:
        the solution; its `kkt` may exceed the tolerance, which is the caller's to judge.
    """
    p, iterations = _by_gradient(J, b + J @ u_star, mass, p, contact, tolerance)
    u = u_star + (J.T @ p) / mass
    kkt = contact.residual(b + J @ u, p, J.multiply(J) @ (1.0 / mass))
    if kkt <= tolerance:
        return Impulses(p, u, kkt, iterations, 0)
    if not contact.only_gaps:
        best = minimise(J, b, mass, u_star, p, contact, tolerance)
        return Impulses(best.p, best.u, best.residual, iterations, best.steps)
    best = minimise(J, b, mass, u_star, approach(J, b, mass, u_star, p), contact, ROUGHLY * tolerance)
    p, kkt = polish(J, b, mass, u_star, best.p, contact, tolerance)
    return Impulses(p, u_star + (J.T @ p) / mass, kkt, iterations, best.steps)


def _by_gradient(
    J: sp.csr_matrix, c: Array, mass: Array, p: Array, contact: Contact, tolerance: float
) -> tuple[Array, int]:
    """Impulses when the residual is tolerated or falls too slowly, and after how many iterations."""
    s = 1.0 / np.sqrt(J.multiply(J) @ (1.0 / mass) + contact.compliance)
    moved = np.unique(J.indices)  # what no row moves costs time
    B = sp.csr_matrix(sp.diags(s) @ J[:, moved] @ sp.diags(1.0 / np.sqrt(mass[moved])))
    Bt, cs = B.T.tocsr(), s * c
    own = s * s * contact.compliance if contact.compliance.any() else None
    least = contact.least / s

    def gradient(z: Array) -> Array:
        g: Array = B @ (Bt @ z)
        g += cs
        if own is not None:
            g += own * z
        return g

    def onto(z: Array) -> Array:
        projected: Array = np.maximum(z, least) if len(least) == len(z) else contact.onto(s * z) / s
        return projected

    step = 1.0 / _largest(lambda z: gradient(z) - cs, len(c))
    z = onto(p / s)
    y, theta = z, 1.0
    best, before = np.inf, np.inf
    for iteration in range(MOST_ITERATIONS):
        if iteration % CHECK_EVERY == 0:
            best = min(best, _far(z - onto(z - gradient(z)), s))
            if best <= tolerance or (iteration % PATIENCE == 0 and best > 0.5 * before):
                return s * z, iteration
            before = best if iteration % PATIENCE == 0 else before
        new = onto(y - step * gradient(y))
        moves = new - z
        if (y - new) @ moves > 0.0:
            theta, y = 1.0, new
        else:
            following = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * theta * theta))
            moves *= (theta - 1.0) / following
            moves += new
            theta, y = following, moves
        z = new
    return s * z, MOST_ITERATIONS


def _far(z: Array, s: Array) -> float:
    """A scaled impulse as the residual that it is."""
    return float((np.abs(z) / s).max(initial=0.0))


def _largest(W: Callable[[Array], Array], rows: int) -> float:
    """An upper bound of the largest eigenvalue of W, by Lanczos with a margin for its tolerance."""
    if rows < 3:
        return float(np.linalg.norm(np.column_stack([W(e) for e in np.eye(rows)]), 2)) if rows else 1.0
    operator = LinearOperator((rows, rows), matvec=W, dtype=float)
    start = np.cos(np.arange(rows, dtype=float))  # any vector that is not special, the same in every run
    return 1.05 * float(eigsh(operator, k=1, which="LA", tol=1e-2, v0=start, return_eigenvectors=False)[0])
