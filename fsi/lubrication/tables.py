"""A lubrication profile K(s) that is known at points: interpolated in ln s and ln K."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator, make_interp_spline

Array = NDArray[np.float64]

# Of each interval between points; there K is the exponential of a polynomial of low degree.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)


@dataclass(frozen=True, slots=True)
class TabulatedProfile:
    """K(s) through the given points; beyond them the power of s that fits value and slope of the last.

    Attributes:
        s: increasing, > 0, shape (n,), n >= 2.
        K: positive, decreasing, (n,).
        smooth: whether ln K is a spline of degree 5, for values exact to many digits, n >= 6; otherwise
            Fritsch and Carlson's monotone cubic.
    """

    s: Array
    K: Array
    smooth: bool = False
    _curve: PchipInterpolator = field(init=False, repr=False)
    _slope: PchipInterpolator = field(init=False, repr=False)
    _until: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Interpolate, and integrate from the last point, so that small integrals keep their digits."""
        x, y = np.log(self.s), np.log(self.K)
        curve = make_interp_spline(x, y, k=5) if self.smooth else PchipInterpolator(x, y)
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
        x = np.log(inside)
        value: Array = np.exp(self._curve(x))
        beyond = s != inside
        if np.any(beyond):
            value = np.where(beyond, value * (s / inside) ** self._slope(x), value)
        return value

    def integral(self, s: Array) -> Array:
        """The integral of K from the last point to s."""
        inside = np.clip(s, *self.range)
        x = np.log(inside)
        k = np.clip(np.searchsorted(self.s, inside, side="right") - 1, 0, len(self.s) - 2)
        integral: Array = self._until[k] + self._between(np.log(self.s)[k], x)
        beyond = s != inside
        if np.any(beyond):
            integral = np.where(beyond, integral + self._tail(s, inside, x), integral)
        return integral

    def _between(self, start: Array, end: Array) -> Array:
        """The integral of K ds = K s d ln s between logarithms of one interval of the table."""
        half = 0.5 * (end - start)
        x = (0.5 * (start + end))[..., None] + half[..., None] * _NODES
        integral: Array = half * (np.exp(self._curve(x) + x) @ _WEIGHTS)
        return integral

    def _tail(self, s: Array, end: Array, x: Array) -> Array:
        """The integral of K(end) (s/end)^p from `end` to s."""
        power = self._slope(x) + 1.0
        log = np.log(s / end)
        # expm1(power log)/power, which tends to the logarithm as power -> 0
        ratio = np.where(power == 0.0, log, np.expm1(power * log) / np.where(power == 0.0, 1.0, power))
        tail: Array = np.exp(self._curve(x)) * end * ratio
        return tail
