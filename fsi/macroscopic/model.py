"""The macroscopic gluey model on a line, in Lagrangian form.

    rho_t + (rho u)_x = 0,   (rho u)_t + (rho u^2)_x + p_x = rho f,   gamma_t + (gamma u)_x = -p,
    gamma <= 0,   rho <= 1,   gamma (1 - rho) = 0

The rods of a congested stretch touch (rho = 1); pi = -gamma stores the impulse that pushed them together.
With the mass coordinate m, X(m, t) the position of a parcel and `w = u + d pi/dm`, a step h is

    w += h f,     X^{n+1} = m + isotonic regression of (X^n + h w - m),     u = (X^{n+1} - X^n) / h,

the L2 projection of the free motion onto `dX/dm >= 1`, and `pi = int (w - u) dm`. First order in h.

Source: B. Maury & A. Preux, Pressureless Euler equations with maximal density constraint, in Topological
Optimization and Optimal Transport (de Gruyter 2017); E. Cavalletti, M. Sedjro & M. Westdickenberg, Trans.
Amer. Math. Soc. 371 (2019) 5081. Here f is a force per mass.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression

from fsi.bodies.configuration import Array

type Force = Callable[[Array, Array, float], Array]


@dataclass(frozen=True, slots=True)
class Parcels:
    """The state: parcels of equal mass dm, from left to right.

    m: mass left of each parcel's middle, shape (n,); X: positions; u: velocities; w: u + d pi/dm.
    """

    m: Array
    dm: float
    X: Array
    u: Array
    w: Array

    def advance(self, f: Force, t: float, h: float) -> Parcels:
        """The state after a step h; f(x, m, t) is taken half-way in time."""
        w = self.w + h * f(self.X, self.m, t + 0.5 * h)
        X = self.m + isotonic_regression(self.X + h * w - self.m).x
        return Parcels(self.m, self.dm, X, (X - self.X) / h, w)

    @property
    def gamma(self) -> Array:
        """`-int (w - u) dm` between parcels and at both ends, where it is 0, shape (n + 1,)."""
        pi = np.append(0.0, np.cumsum(self.w - self.u) * self.dm)
        return -pi

    @property
    def density(self) -> Array:
        """rho between neighbouring parcels, shape (n - 1,)."""
        return self.dm / np.diff(self.X)


def at_rest_in_memory(m: Array, dm: float, X: Array, u: Array) -> Parcels:
    """Parcels that have not been pushed yet: w = u."""
    return Parcels(m, dm, X, u, u)


def blocks(pieces: list[tuple[float, float, float]], n: int) -> tuple[Array, float, Array, NDArray[np.intp]]:
    """m, dm, X and the block of n parcels of equal mass in blocks (left, right, density), from left to right.

    Every block holds whole parcels when its mass is a multiple of dm; the others' parcels lie where the
    inverse of the mass left of x has them.
    """
    mass = np.array([(right - left) * rho for left, right, rho in pieces])
    ends = np.append(0.0, np.cumsum(mass))
    dm = float(ends[-1]) / n
    m = (np.arange(n) + 0.5) * dm
    block = np.minimum(np.searchsorted(ends, m, side="right") - 1, len(pieces) - 1)
    left, _, rho = np.array(pieces).T
    X: Array = left[block] + (m - ends[block]) / rho[block]
    return m.astype(float), dm, X, block
