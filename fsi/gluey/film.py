"""Films of fluid at eps > 0: `gamma = eps Psi'(D)`, and the answer of a pair to its gap.

Spheres: `Psi' = ln(D/delta0)`; discs: `Psi' = 2 (1 - (D/delta0)^{-1/2})`. Both vanish at delta0, where a
film begins. The unknown is gamma, as D underflows.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import override

import numpy as np
import scipy.sparse as sp
from scipy.special import wrightomega

from fsi.arrays import Array


@dataclass(frozen=True, slots=True)
class Film(ABC):
    """Rows with viscosity, in a step h: `D + h G.u = s`, `p = -eps Psi'(s)`.

    A kind of surfaces says what `y = Psi'(x)` is, y = gamma/eps at the gap x = D/delta0.

    Attributes:
        eps: of a pair, > 0, an impulse.
        delta0: where films begin.
        h: the step.
    """

    eps: float
    delta0: float
    h: float

    @staticmethod
    @abstractmethod
    def memory(x: Array) -> Array:
        """y at x, 0 <= x <= 1, shape of x; minus infinity at 0."""

    @staticmethod
    @abstractmethod
    def opening(y: Array) -> Array:
        """x of y <= 0."""

    @staticmethod
    @abstractmethod
    def mobility(y: Array) -> Array:
        """dx/dy."""

    @staticmethod
    @abstractmethod
    def implicit(R: Array, c: Array) -> Array:
        """The solution y of `x(y) + c y = R`, c > 0."""

    def gamma(self, D: Array) -> Array:
        """The memory of gaps D > 0, which is at most 0."""
        with np.errstate(divide="ignore"):
            return self.eps * self.memory(np.minimum(D / self.delta0, 1.0))

    def gap(self, gamma: Array) -> Array:
        """D of memories gamma <= 0; 0 where it underflows."""
        return self.delta0 * self.opening(gamma / self.eps)

    def impulse(self, r: Array, p_old: Array, sigma: Array) -> tuple[Array, sp.spmatrix]:
        """The solution of `D(-p)/h - p/sigma = r - p_old/sigma`, and `-dp/dr`; 0 for pairs beyond delta0."""
        z = r - p_old / sigma
        p = self._solve(z, sigma)
        # dp/dr = -1/(dD/dgamma / h + 1/sigma)
        of_gap = self.mobility(-p / self.eps) * self.delta0 / self.eps
        slope = 1.0 / (of_gap / self.h + 1.0 / sigma)
        near = z < self.delta0 / self.h
        return np.where(near, p, 0.0), sp.diags(np.where(near, slope, 0.0)).tocsr()

    def _solve(self, z: Array, sigma: Array) -> Array:
        """p >= 0 with `D(-p)/h = z + p/sigma`."""
        y = self.implicit(self.h * z / self.delta0, self.eps * self.h / (sigma * self.delta0))
        p: Array = np.maximum(-self.eps * y, 0.0)
        return p

    def scales(self, weight: Array) -> Array:
        """Each row by itself."""
        return weight

    def residual(self, r: Array, p: Array, weight: Array) -> float:
        """The largest of `r - D(-p)/h` where films are, of `delta0/h - r` beyond, and of p's own error."""
        answer, _ = self.impulse(r, p, 1.0 / weight)
        beyond = np.maximum(self.delta0 / self.h - r, 0.0)
        in_gap = np.where(p > 0.0, np.abs(r - self.gap(-p) / self.h), beyond)
        return float(np.maximum(in_gap, np.abs(answer - p) * weight).max(initial=0.0))


class SphereFilm(Film):
    """Between spheres, `y = ln x`."""

    __slots__ = ()

    @staticmethod
    @override
    def memory(x: Array) -> Array:
        return np.asarray(np.log(x))

    @staticmethod
    @override
    def opening(y: Array) -> Array:
        return np.asarray(np.exp(y))

    @staticmethod
    @override
    def mobility(y: Array) -> Array:
        return np.asarray(np.exp(y))

    @staticmethod
    @override
    def implicit(R: Array, c: Array) -> Array:
        return log_gap(R, c)


class DiscFilm(Film):
    """Between discs, `y = 2 (1 - x^(-1/2))`."""

    __slots__ = ()

    @staticmethod
    @override
    def memory(x: Array) -> Array:
        return np.asarray(2.0 * (1.0 - x**-0.5))

    @staticmethod
    @override
    def opening(y: Array) -> Array:
        return np.asarray((1.0 - 0.5 * y) ** -2.0)

    @staticmethod
    @override
    def mobility(y: Array) -> Array:
        return np.asarray((1.0 - 0.5 * y) ** -3.0)

    @staticmethod
    @override
    def implicit(R: Array, c: Array) -> Array:
        """By r = sqrt(x), of which `r^2 + 2 c (1 - 1/r) = R`."""
        return 2.0 * (1.0 - 1.0 / _positive_root(R - 2.0 * c, 2.0 * c))


def log_gap(R: Array | float, c: Array | float) -> Array:
    """The solution y of `exp(y) + c y = R`, c > 0.

    With z = exp(y)/c it reads `z + ln z = R/c - ln c`, so z is Wright's omega function of the right side.
    """
    z = wrightomega(R / c - np.log(c))
    # Where z is large, R/c - z cancels; where it is small, its logarithm underflows.
    y: Array = np.where(z > 1.0, np.log(c * np.maximum(z, 1.0)), R / c - z)
    return y


def _positive_root(R: Array, k: Array) -> Array:
    """The positive root of `x^3 - R x - k = 0`, k > 0 (it is the only one), by Newton from the right."""
    x = np.sqrt(np.maximum(R, 0.0)) + np.cbrt(k)
    for _ in range(60):
        step = (x * x * x - R * x - k) / (3.0 * x * x - R)
        x = x - step
        if np.all(np.abs(step) <= 1e-15 * x):
            break
    return x
