"""The exact quasi-static motion of a sphere along the normal of a plane, under a constant force.

`q' = F / (6 pi mu a lambda(s))`, s = q/a, with the signs and arguments of `fsi.lubrication.spheres`. F < 0
pushes the sphere towards the plane, which it never reaches: q falls off like `exp(-t |F| / (6 pi mu a^2))`.
In y = ln s the time, in units of 6 pi mu a^2 / F, is the integral of `s lambda`, which is analytic for
|Im y| < pi, tends to 1 at small gaps and grows with y: Gauss's rule on panels of width 2 gives it. Relative
error of a time: below 1e-12, but never less than 1e-15 of the unit. Relative error of a gap: about 1e-15
times the time in these units.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike, NDArray

from fsi.lubrication.exact import gap_ratio
from fsi.lubrication.spheres import normal_resistance

Array = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_PANEL = 2.0
_LOWEST, _HIGHEST = -36.0, 16.0  # the range of y in which s lambda is interpolated
_DEGREE = 400


def settling_time(
    gap: ArrayLike, start: ArrayLike, radius: ArrayLike, viscosity: ArrayLike, force: ArrayLike
) -> Array:
    """Time in which a sphere goes from the gap `start` to `gap` under a constant force F, without inertia.

    Negative where the sphere was at `gap` before it was at `start`.
    """
    y, y0 = np.log(np.broadcast_arrays(gap_ratio(gap, radius), gap_ratio(start, radius)))
    return _rise_time(y, y0) * _time_unit(radius, viscosity, force)


def settling_gap(
    time: ArrayLike, start: ArrayLike, radius: ArrayLike, viscosity: ArrayLike, force: ArrayLike
) -> Array:
    """Gap at `time` of a sphere that leaves the gap `start` at t = 0: the inverse of `settling_time`.

    Newton's method in y = ln s, in which the time is convex and increasing: from any y right of the root it
    converges without overshoot. Such a y follows from `s lambda > max(1, s)`.
    """
    rise = np.asarray(time) / _time_unit(radius, viscosity, force)
    y0, rise = np.broadcast_arrays(np.log(gap_ratio(start, radius)), rise)
    up = np.maximum(rise, 0.0)
    y = np.minimum(y0 + up, np.logaddexp(y0, np.log(np.maximum(up, 1e-300))))
    rest = rise - _rise_time(y, y0)
    for _ in range(100):
        step = rest / _slope(y)
        rest = rest - _rise_time(y + step, y)
        y = y + step
        if np.all(np.abs(step) < 1e-15 * np.maximum(1.0, np.abs(y))):
            break
    gap: Array = np.exp(y) * np.asarray(radius)
    return gap


def _time_unit(radius: ArrayLike, viscosity: ArrayLike, force: ArrayLike) -> Array:
    """6 pi mu a^2 / F, signed like the force."""
    unit: Array = 6.0 * np.pi * np.asarray(viscosity) * np.square(radius) / np.asarray(force)
    return unit


def _slope(y: Array) -> Array:
    """The integrand s lambda(s) at y = ln s: 1 to rounding below the range, s + 9/8 above it."""
    s = np.exp(y)
    inside = (1.0 + s) * _hump()(np.clip(y, _LOWEST, _HIGHEST))
    return np.where(y < _LOWEST, 1.0, np.where(y < _HIGHEST, inside, s + 1.125))


@cache
def _hump() -> Chebyshev:
    """s lambda / (1 + s) over y = ln s, interpolated once: the series of lambda would be 100 times slower."""

    def hump(y: Array) -> Array:
        s = np.exp(y)
        ratio: Array = normal_resistance(s, 1.0, 1.0) / (6.0 * np.pi * (1.0 + 1.0 / s))
        return ratio

    return Chebyshev.interpolate(hump, _DEGREE, domain=[_LOWEST, _HIGHEST])


def _rise_time(y: Array, y0: Array) -> Array:
    """The integral of s lambda over y from y0 to y."""
    panels = max(1, int(np.ceil(np.max(np.abs(y - y0), initial=0.0) / _PANEL)))
    half = (0.5 / panels) * (y - y0)
    centres = 2.0 * np.arange(panels) + 1.0
    t = y0[..., None] + half[..., None] * (centres[:, None] + _NODES).ravel()
    time: Array = half * (_slope(t) @ np.tile(_WEIGHTS, panels))
    return time
