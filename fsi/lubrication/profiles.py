"""Profiles K(s) of lubrication laws: series, and tables of values, with their antiderivatives in s."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import reduce
from typing import Protocol

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import ArrayLike

from fsi.arrays import Array

# Of each interval between points; there K is the exponential of a polynomial of low degree.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)


class Profile(Protocol):
    """The dimensionless K(s) of one geometry."""

    @property
    def range(self) -> tuple[float, float]:
        """The smallest and largest s for which it holds."""

    def value(self, s: Array) -> Array:
        """K(s); beyond the range a continuation of it."""

    def integral(self, s: Array) -> Array:
        """An antiderivative of K in s."""

    def at(self, overlap: Array) -> "Profile":
        """That of films of these k = a b/(a + b)^2, (P,): itself unless it is one of any k."""


def distinct(radius: ArrayLike) -> Array:
    """Radii or k of films, (1,) if all are one: what depends on them alone is then the same for all."""
    a = np.asarray(radius, dtype=np.float64)
    return a[:1] if a.ndim == 1 and len(a) > 1 and np.all(a == a[0]) else a


@dataclass(frozen=True, slots=True)
class Term:
    """One term of a series: s^power, or s^power ln(1/s)."""

    power: float
    log: bool = False

    def value(self, s: Array) -> Array:
        """The term at s, shape of s."""
        power: Array = s**self.power
        return -power * np.log(s) if self.log else power

    def integral(self, s: Array) -> Array:
        """ln s of 1/s, s^(p+1)/(p+1) of s^p, s^(p+1)/(p+1) (ln(1/s) + 1/(p+1)) of s^p ln(1/s)."""
        p = self.power + 1.0
        if p == 0.0:
            log = np.log(s)
            return -0.5 * log**2 if self.log else log
        integral: Array = s**p / p
        return integral * (1.0 / p - np.log(s)) if self.log else integral

    def slope(self, s: Array) -> Array:
        """The derivative of the term times s."""
        slope: Array = self.power * self.value(s)
        return slope - s**self.power if self.log else slope

    def __str__(self) -> str:
        power = "" if self.power == 0.0 else "s" if self.power == 1.0 else f"s^{self.power:g}"
        return " ".join(part for part in (power, "ln(1/s)" if self.log else "") if part) or "1"


@dataclass(frozen=True, slots=True)
class Series:
    """K(s) = sum_k c_k phi_k(s); beyond the range the power of s that fits value and slope of its end.

    A fitted sum means nothing there, where its highest powers rule. Below the range the lowest one does, the
    leading term, and the sum goes on.

    Attributes:
        terms: phi_k.
        coefficients: c_k, as many.
        range: where it holds; all s > 0 if not given.
    """

    terms: tuple[Term, ...]
    coefficients: tuple[float, ...]
    range: tuple[float, float] = (0.0, np.inf)

    def value(self, s: Array) -> Array:
        """K(s)."""
        inside = np.minimum(s, self.range[1])
        value = self._sum(term.value(inside) for term in self.terms)
        beyond = s != inside
        if np.any(beyond):
            _, power = self.end
            value = np.where(beyond, value * (s / inside) ** power, value)
        return value

    def integral(self, s: Array) -> Array:
        """The sum of the antiderivatives of the terms, beyond the range from its end on."""
        inside = np.minimum(s, self.range[1])
        integral = self._sum(term.integral(inside) for term in self.terms)
        beyond = s != inside
        if np.any(beyond):
            integral = np.where(beyond, integral + _integral_of_power(s, inside, *self.end), integral)
        return integral

    def at(self, _: Array) -> "Series":
        """Itself."""
        return self

    @property
    def end(self) -> tuple[float, float]:
        """K where the range ends, and the power of s that has its slope there; infinite if K = 0."""
        s = np.array(self.range[1])
        K = float(self._sum(term.value(s) for term in self.terms))
        slope = float(self._sum(term.slope(s) for term in self.terms))
        return K, slope / K if K != 0.0 else np.inf

    def _sum(self, values: Iterable[Array]) -> Array:
        terms = (c * v for c, v in zip(self.coefficients, values, strict=True))
        return reduce(np.add, terms)  # without a copy of all, as a sum of a list would make


@dataclass(frozen=True, slots=True)
class TabulatedProfile:
    """K(s) through the given points; beyond them the power of s that fits value and slope of the last.

    Attributes:
        s: increasing, > 0, shape (n,), n >= 2.
        K: positive, decreasing, (n,).
        smooth: whether ln K is a spline of degree 5, n >= 6, or else Fritsch and Carlson's monotone cubic.
        limit: what K tends to far away, below all K; after the last point the power is that of K - limit.
    """

    s: Array
    K: Array
    smooth: bool = False
    limit: float = 0.0
    _curve: "scipy.interpolate.PchipInterpolator" = field(init=False, repr=False)
    _slope: "scipy.interpolate.PchipInterpolator" = field(init=False, repr=False)
    _until: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Interpolate, and integrate from the last point, so that small integrals keep their digits."""
        x, y = np.log(self.s), np.log(self.K)
        of = scipy.interpolate
        curve = of.make_interp_spline(x, y, k=5) if self.smooth else of.PchipInterpolator(x, y)
        object.__setattr__(self, "_curve", curve)
        object.__setattr__(self, "_slope", curve.derivative())
        parts = self._between(x[:-1], x[1:])
        object.__setattr__(self, "_until", np.concatenate([-np.cumsum(parts[::-1])[::-1], [0.0]]))

    @property
    def range(self) -> tuple[float, float]:
        """The first and the last point."""
        return float(self.s[0]), float(self.s[-1])

    def value(self, s: Array) -> Array:
        """K(s)."""
        inside = np.clip(s, *self.range)
        value: Array = np.exp(self._curve(np.log(inside)))
        beyond = s != inside
        if np.any(beyond):
            limit, rest, power = self._end(s, inside)
            value = np.where(beyond, limit + rest * (s / inside) ** power, value)
        return value

    def integral(self, s: Array) -> Array:
        """The integral of K from the last point to s."""
        inside = np.clip(s, *self.range)
        x = np.log(inside)
        k = np.clip(np.searchsorted(self.s, inside, side="right") - 1, 0, len(self.s) - 2)
        integral: Array = self._until[k] + self._between(np.log(self.s)[k], x)
        beyond = s != inside
        if np.any(beyond):
            limit, rest, power = self._end(s, inside)
            tail = limit * (s - inside) + _integral_of_power(s, inside, rest, power)
            integral = np.where(beyond, integral + tail, integral)
        return integral

    def at(self, _: Array) -> "TabulatedProfile":
        """Itself."""
        return self

    def _end(self, s: Array, inside: Array) -> tuple[Array, Array, Array]:
        """The limit towards which K goes from `inside` to s, K - limit there, and the power of that."""
        x, limit = np.log(inside), np.where(s > inside, self.limit, 0.0)
        K = np.exp(self._curve(x))
        return limit, K - limit, K * self._slope(x) / (K - limit)

    def _between(self, start: Array, end: Array) -> Array:
        """The integral of K ds = K s d ln s between logarithms of one interval of the table."""
        half = 0.5 * (end - start)
        x = (0.5 * (start + end))[..., None] + half[..., None] * _NODES
        return np.asarray(half * (np.exp(self._curve(x) + x) @ _WEIGHTS))


def _integral_of_power(s: Array, start: Array, K: Array | float, power: Array | float) -> Array:
    """The integral of K (s/start)^power from `start` to s."""
    raised = np.asarray(power) + 1.0
    log = np.log(s / start)
    # expm1(raised log)/raised, which tends to the logarithm as raised -> 0
    ratio = np.where(raised == 0.0, log, np.expm1(raised * log) / np.where(raised == 0.0, 1.0, raised))
    return np.asarray(K * start * ratio)
