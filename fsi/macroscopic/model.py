"""The macroscopic gluey model on a line, in Lagrangian form.

    rho_t + (rho u)_x = 0,   (rho u)_t + (rho u^2)_x + p_x = rho f,   gamma_t + (gamma u)_x = -p,
    gamma <= 0,   rho <= 1,   gamma (1 - rho) = 0

The rods of a congested stretch touch (rho = 1); pi = -gamma stores the impulse that pushed them together.
With the mass coordinate m, `X(m, t) = left + m + s` the position of a parcel, s the room free of matter left
of it, and `w = u + d pi/dm`, a step h is

    w += h f,     u = isotonic regression of (w + s/h) - s/h,     s += h u,

the L2 projection of the free motion onto `ds/dm >= 0`, and `pi = int (w - u) dm`. First order in h. Where
nothing meets u = w: places, of which rounding is as large as they are far from the origin, make no velocity.

Source: B. Maury & A. Preux, Pressureless Euler equations with maximal density constraint, in Topological
Optimization and Optimal Transport (de Gruyter 2017); E. Cavalletti, M. Sedjro & M. Westdickenberg, Trans.
Amer. Math. Soc. 371 (2019) 5081. Here f is a force per mass.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression

from fsi.arrays import Array

type Force = Callable[[Array, Array, float], Array]


@dataclass(frozen=True, slots=True)
class Parcels:
    """The state: parcels of equal mass dm, from left to right.

    m: mass left of each parcel's middle, shape (n,); left: the left end at time 0; slack: s; u: velocities;
    w: u + d pi/dm.
    """

    m: Array
    dm: float
    left: float
    slack: Array
    u: Array
    w: Array

    def moving(self, u: Array) -> Parcels:
        """Parcels with these velocities that have not been pushed yet: w = u."""
        return replace(self, u=u, w=u)

    def advance(self, f: Force, t: float, h: float) -> Parcels:
        """The state after a step h; f(x, m, t) is taken half-way in time."""
        w = self.w + h * f(self.X, self.m, t + 0.5 * h)
        pools = _pools(self.slack, w, h)
        count = np.diff(pools)
        first = np.repeat(pools[:-1], count)
        behind = (self.slack - self.slack[first]) / h  # how much slower each is, to come as far
        pooled = np.repeat(np.add.reduceat(w + behind, pools[:-1]) / count, count)
        slack = np.maximum.accumulate(self.slack[first] + h * pooled)  # in order, also in rounding
        return replace(self, slack=slack, u=pooled - behind, w=w)

    @property
    def X(self) -> Array:
        """Positions, (n,)."""
        return self.left + (self.m + self.slack)

    @property
    def gaps(self) -> Array:
        """Between neighbouring parcels, 0 in contact, (n - 1,)."""
        return np.diff(self.slack)

    @property
    def gamma(self) -> Array:
        """`-int (w - u) dm` between parcels and at both ends, where it is 0, shape (n + 1,)."""
        pi = np.append(0.0, np.cumsum(self.w - self.u) * self.dm)
        return 0.0 - pi

    @property
    def density(self) -> Array:
        """rho between neighbouring parcels, shape (n - 1,)."""
        return self.dm / (self.dm + self.gaps)


def _pools(slack: Array, w: Array, h: float) -> NDArray[np.intp]:
    """Where the pools of the regression of w + s/h begin, and n: parcels that touch or meet in the step.

    Gaps that no difference of velocities closes have a width that none closes, so that s/h drowns no w.
    """
    wide = 4.0 * float(np.abs(w).max()) or 1.0  # at rest any width will do
    apart = np.append(0.0, np.cumsum(np.minimum(np.diff(slack) / h, wide)))
    pools: NDArray[np.intp] = isotonic_regression(w + apart).blocks
    return pools


def blocks(pieces: list[tuple[float, float, float]], n: int) -> tuple[Parcels, NDArray[np.intp]]:
    """n parcels at rest in blocks (left, right, density), from left to right, and the block of each.

    A block holds whole parcels when its mass is a multiple of dm. Ends that differ by rounding touch.
    """
    left, right, rho = np.array(pieces).T
    mass = (right - left) * rho
    ends = np.append(0.0, np.cumsum(mass))
    dm = float(ends[-1]) / n
    m = ((np.arange(n) + 0.5) * dm).astype(float)
    block = np.minimum(np.searchsorted(ends, m, side="right") - 1, len(pieces) - 1)
    between = left[1:] - right[:-1]
    between[between <= 8.0 * np.finfo(float).eps * np.abs([left, right]).max()] = 0.0
    before = np.append(0.0, np.cumsum(between + (right - left - mass)[:-1]))
    slack = before[block] + (m - ends[block]) * (1.0 / rho[block] - 1.0)
    at_rest = np.zeros(n)
    return Parcels(m, dm, float(left[0]), slack, at_rest, at_rest), block
