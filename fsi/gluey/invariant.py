"""One body above a wall at eps > 0: `q'' = -eps q'/q + f` by its first integral.

    w = q' + gamma,  gamma = eps ln q,   w' = f       so that      q' = w(t) - gamma,  w known exactly.

The unknown is gamma, since q = exp(gamma/eps) underflows where the body sticks: then the equation turns into
`gamma = w` by itself, and no memory is lost. Each implicit stage is solved in closed form by the Wright
omega function. Source of the method: E. Hairer & G. Wanner, Solving Ordinary Differential Equations II,
table IV.6.5: SDIRK of order 4, L-stable, stiffly accurate, so of order 4 where the equation is algebraic,
too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PPoly
from scipy.special import wrightomega

from fsi.bodies import Array

A = np.array(
    [
        [1 / 4, 0, 0, 0, 0],
        [1 / 2, 1 / 4, 0, 0, 0],
        [17 / 50, -1 / 25, 1 / 4, 0, 0],
        [371 / 1360, -137 / 2720, 15 / 544, 1 / 4, 0],
        [25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4],
    ]
)
C = A.sum(axis=1)
EMBEDDED = np.array([59 / 48, -17 / 96, 225 / 32, -85 / 12, 0])
DIAGONAL = 1 / 4
# Errors of a step that are tolerated: in q relative and absolute, in gamma.
RELATIVE, ABSOLUTE, IN_GAMMA = 1e-10, 1e-16, 1e-7
# Of the time span: on arrival gamma turns within what rounding leaves of t. Such a step is taken as it is,
# since an error of gamma does not last where the body sticks: gamma returns to w.
SHORTEST = 1e-15


@dataclass(frozen=True, slots=True)
class Path:
    """A solution at times t, shapes (n,): the distance q (0 where it underflows) and gamma = eps ln q."""

    t: Array
    q: Array
    gamma: Array


def log_gap(r: float, c: float) -> float:
    """The solution y of `exp(y) + c y = r`, c > 0: one implicit stage, with y = gamma/eps = ln q.

    With z = exp(y)/c it reads `z + ln z = r/c - ln c`, so z is Wright's omega function of the right side.
    """
    z = float(wrightomega(r / c - np.log(c)))
    # Where z is large, r/c - z cancels; where it is small, its logarithm underflows.
    return float(np.log(c * z)) if z > 1.0 else r / c - z


def solve(q0: float, u0: float, f: PPoly, eps: float, t: Array) -> Path:
    """The solution at the increasing times t >= 0.

    Args:
        q0: distance at time 0, > 0.
        u0: velocity at time 0.
        f: force per mass, a piecewise polynomial that begins at time 0; steps land on its breaks.
        eps: > 0.
        t: increasing times within the range of f.
    """
    w = f.antiderivative()
    w.c[-1] += u0 + eps * np.log(q0)
    stops = np.unique(np.concatenate([t, f.x[(f.x > 0.0) & (f.x < t[-1])]]))
    q, gamma, now, h = q0, eps * np.log(q0), 0.0, 1e-3 * (t[-1] or 1.0)
    found: dict[float, tuple[float, float]] = {0.0: (q, gamma)}
    for stop in stops[stops > 0.0]:
        while now < stop:
            landing = now + h >= stop * (1.0 - 1e-14)
            used = stop - now if landing else h
            q1, gamma1, error = _step(q, gamma, w, now, used, eps)
            growth = min(4.0, max(0.1, 0.9 * max(error, 1e-12) ** -0.25))
            if error > 1.0 and used > SHORTEST * t[-1]:
                h = used * growth
                continue
            q, gamma, now = q1, gamma1, float(stop) if landing else now + used
            h = max(h, used * growth) if landing else used * growth
        found[float(stop)] = (q, gamma)
    values = np.array([found[float(time)] for time in t])
    return Path(t, values[:, 0], values[:, 1])


def _step(q: float, gamma: float, w: PPoly, t: float, h: float, eps: float) -> tuple[float, float, float]:
    """q and gamma after a step, and its estimated error over what is tolerated."""
    slopes = np.zeros(5)
    given = w(np.minimum(t + h * C, np.nextafter(t + h, t)))  # the piece of this step also at its end
    stage = gamma
    c = DIAGONAL * h * eps
    for i in range(5):
        r = q + h * float(A[i, :i] @ slopes[:i]) + DIAGONAL * h * float(given[i])
        y = log_gap(r, c)
        stage = eps * y
        slopes[i] = given[i] - stage
    q1 = float(np.exp(stage / eps))
    raw = abs(h * float((A[-1] - EMBEDDED) @ slopes))
    # The estimate filtered by (1 + h eps / (4 q))^-1, as stiff equations want it.
    in_q, in_gamma = raw * q1 / (q1 + c), raw * eps / (q1 + c)
    return q1, stage, max(in_q / (RELATIVE * q1 + ABSOLUTE), in_gamma / IN_GAMMA)
