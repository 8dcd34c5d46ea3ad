"""One body above a wall as the viscosity vanishes: the exact limit for any force, and the first-order scheme.

    q'' = -eps q'/q + f,  q(0) = q0 > 0,  q'(0) = u0,          gamma_eps = eps ln q

As eps -> 0, with `utilde = u0 + int f`,

    q' + gamma = utilde,   q >= 0,   gamma <= 0,   q gamma = 0.

While the body sticks, `gamma` stores the impulse of the push, and a pull must pay it back before release.
Source: B. Maury, A gluey particle model, ESAIM Proc. 18 (2007) 133; A. Lefebvre, Numerical simulation
of gluey particles, M2AN 43 (2009) 53. The unit of mass is that of the body.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PPoly

from fsi.bodies.configuration import Array


@dataclass(frozen=True, slots=True)
class Limit:
    """The limit by Skorokhod's reflection: `Q = q0 + int utilde`, `q(t) = Q(t) - min(0, min_{s <= t} Q(s))`.

    utilde: `u0 + int f`; Q: its integral plus q0, both piecewise polynomials in t >= 0;
    lowest: times at which Q takes extreme values between its ends, increasing.
    """

    utilde: PPoly
    Q: PPoly
    lowest: Array

    @classmethod
    def of(cls, q0: float, u0: float, f: PPoly) -> Limit:
        """The limit for a force per mass f, any piecewise polynomial that begins at t = 0."""
        utilde = f.antiderivative()
        utilde.c[-1] += u0
        Q = utilde.antiderivative()
        Q.c[-1] += q0
        stationary = utilde.roots(discontinuity=False, extrapolate=False)
        # A piece on which utilde vanishes altogether is reported by its left end and NaN.
        return cls(utilde, Q, np.unique(np.append(stationary[np.isfinite(stationary)], f.x)))

    def lowest_until(self, t: Array) -> Array:
        """`min(0, min_{s <= t} Q(s))`."""
        until = np.minimum.accumulate(np.append(0.0, self.Q(self.lowest)))
        passed = until[np.searchsorted(self.lowest, t, side="right")]
        lowest: Array = np.minimum(passed, self.Q(t))
        return lowest

    def q(self, t: Array) -> Array:
        """The distance, shape of t; exactly 0 in contact."""
        q: Array = self.Q(t) - self.lowest_until(t)
        return q

    def gamma(self, t: Array) -> Array:
        """The memory: `min(utilde, 0)` in contact, 0 elsewhere."""
        touching = self.q(t) <= self._rounding()
        gamma: Array = np.where(touching, np.minimum(self.utilde(t), 0.0), 0.0)
        return gamma

    def contacts(self) -> list[tuple[float, float]]:
        """The intervals (contact, release) in which the body sticks, in order; the last may have no end."""
        f = self.utilde.x
        candidates = np.unique(np.concatenate([self.lowest, self._arrivals(), [f[0], f[-1]]]))
        middles = 0.5 * (candidates[1:] + candidates[:-1])
        sticks = self.q(middles) <= self._rounding()
        edges = np.flatnonzero(np.diff(np.concatenate([[0], sticks.astype(int), [0]])))
        times = candidates[edges].reshape(-1, 2)
        return [(float(a), float(b) if b < f[-1] else np.inf) for a, b in times]

    def _arrivals(self) -> Array:
        """Times at which Q falls to its running minimum."""
        levels = np.unique(np.minimum.accumulate(np.append(0.0, self.Q(self.lowest))))
        found = [self.Q.solve(level, discontinuity=False, extrapolate=False) for level in levels]
        times: Array = np.concatenate(found)
        return times[np.isfinite(times)]

    def _rounding(self) -> float:
        """Below this a distance is rounding in Q."""
        return 128.0 * float(np.finfo(float).eps) * float(np.abs(self.Q(self.lowest)).max())


def slides_scheme(q0: float, u0: float, impulses: Array, h: Array) -> tuple[Array, Array, Array]:
    """The scheme of the slides, case by case: a push stores gamma, a pull pays it back before release.

    Args:
        q0: distance at time 0.
        u0: velocity at time 0.
        impulses: `int f dt` over each step, shape (n,).
        h: lengths of the steps, shape (n,).

    Returns:
        q, u, gamma at the ends of all steps and at the start, shape (n + 1,). First order in h.
    """
    q, u, gamma = (np.zeros(len(h) + 1) for _ in range(3))
    q[0], u[0] = q0, u0
    for n, (step, impulse) in enumerate(zip(h, impulses, strict=True)):
        u_tilde = u[n] + impulse + gamma[n]
        if q[n] + step * u_tilde >= 0.0:  # free, or released: what was stored has been paid back
            u[n + 1] = u_tilde
            q[n + 1] = q[n] + step * u_tilde
        else:  # arrives or stays: the velocity that it cannot have is stored
            u[n + 1] = -q[n] / step
            gamma[n + 1] = u_tilde - u[n + 1]
    return q, u, gamma


def piecewise_constant(times: NDArray[np.float64], values: Array) -> PPoly:
    """f with `values[k]` on (times[k], times[k + 1]); times has one entry more than values."""
    return PPoly(np.asarray(values, dtype=float)[None, :], times)
