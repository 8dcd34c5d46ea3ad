"""`min 1/2 |u - u*|_M^2  s.t.  b + J u >= 0` in a crowd, by an interior point method.

With slacks s of the rows, the conditions

    M (u - u*) = J^T p,     s = b + J u,     s_k p_k = mu,     s, p > 0

are followed to mu -> 0 by Mehrotra's predictor and corrector (SIAM J. Optim. 2 (1992) 575), two solves with
one sparse factor of `M + J^T diag(p/s) J` a step. The number of steps hardly depends on the number of bodies,
also where rows depend on each other. As mu -> 0 the factors lose digits, so the last ones are left to
`fsi.gluey.augmented_lagrangian`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu

from fsi.bodies.configuration import Array
from fsi.gluey.quadratic_program import Program

STEPS = 40
# Of the square of the largest rate: where mu is small enough for Newton's method to find what touches.
CLOSE = 1e-10
# Of the way to the boundary s = 0 or p = 0 that a step may go.
WITHIN = 0.995
# Of the largest rate: gaps that are wider do not close.
FAR = 10.0


def approach(program: Program, p: Array) -> Array:
    """Impulses p >= 0, (rows,), 0 where the gap is open; rows with far wider gaps are not looked at.

    Args:
        program: its rows are gaps.
        p: a guess, (rows,): in a crowd impulses add up, to far more than one body's.
    """
    J = program.J
    rate = float(np.abs(J @ program.u_star).max(initial=0.0))
    rate += float(np.abs(J @ (program.velocity(p) - program.u_star)).max(initial=0.0))
    near = np.flatnonzero(program.b <= FAR * rate)
    found = np.zeros(len(p))
    if rate > 0.0 and len(near):
        found[near] = _follow(program.of_rows(near), p[near], rate)
    return found


@dataclass(frozen=True, slots=True)
class _Point:
    """A point of the path: velocities u, slacks s > 0, impulses p > 0; or a step from one."""

    u: Array
    s: Array
    p: Array

    def moved(self, t: float, step: _Point) -> _Point:
        """The point t times a step further."""
        return _Point(self.u + t * step.u, self.s + t * step.s, self.p + t * step.p)

    def room(self, step: _Point) -> float:
        """The part of a step, at most 1, that keeps s and p > 0."""
        return min(_longest(self.s, step.s), _longest(self.p, step.p))


@dataclass(frozen=True, slots=True)
class _Linear:
    """The conditions made linear at a point: the factor, and what the first two of them miss there."""

    program: Program
    at: _Point
    lu: SuperLU
    dual: Array
    primal: Array

    @classmethod
    def of(cls, program: Program, at: _Point) -> _Linear:
        """Raises RuntimeError where the matrix is singular to rounding."""
        J, Jt, mass = program.J, program.J.T.tocsr(), program.mass
        H = (sp.diags(mass) + Jt @ sp.diags(at.p / at.s) @ J).tocsc()
        lu = splu(H, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        return cls(program, at, lu, mass * (at.u - program.u_star) - Jt @ at.p, program.rate(at.u) - at.s)

    def step(self, product: Array) -> _Point:
        """The step that changes s p by `product` and takes both residuals away, to first order."""
        s, p, J = self.at.s, self.at.p, self.program.J
        du = self.lu.solve(-self.dual + J.T @ ((product - p * self.primal) / s))
        ds = J @ du + self.primal
        return _Point(du, ds, (product - p * ds) / s)


def _follow(program: Program, p: Array, rate: float) -> Array:
    """The path to `mu = CLOSE rate^2`, begun with slacks and impulses that are worth the rate at least."""
    weight = program.weight
    p = np.maximum(p, rate / weight)
    u = program.velocity(p)
    at = _Point(u, np.maximum(program.rate(u), rate), p)
    for _ in range(STEPS):
        mu = float((at.s * weight * at.p).mean())
        if mu <= CLOSE * rate**2:
            break
        try:
            linear = _Linear.of(program, at)
        except RuntimeError:  # singular to rounding: mu is as small as it can be
            break
        predictor = linear.step(-at.s * at.p)
        ahead = at.moved(at.room(predictor), predictor)
        left = float((ahead.s * weight * ahead.p).mean()) / mu
        corrector = linear.step(left**3 * mu / weight - at.s * at.p - predictor.s * predictor.p)
        at = at.moved(at.room(corrector), corrector)
    closed: Array = np.where(at.p * weight > at.s, at.p, 0.0)
    return closed


def _longest(x: Array, dx: Array) -> float:
    """The largest step, at most 1, that keeps x > 0."""
    shrinks = dx < 0.0
    return min(1.0, WITHIN * float((x[shrinks] / -dx[shrinks]).min(initial=np.inf)))
