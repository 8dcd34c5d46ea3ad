"""Exact Stokes forces on spheres that move along their line of centres, or along the normal of a plane.

`gap` is the distance q from surface to surface, `radius` a, `other` the second sphere's radius b, `viscosity`
mu, `s = q/a`. Velocities and forces count along one common direction of the line of centres (of a plane: its
normal, away from it); F is the EXTERNAL force that the motion needs (the fluid exerts the opposite).
Arguments may be arrays; arrays broadcast. Gaps must be positive; others raise ValueError. Relative error: a
few 1e-15, measured for gaps from 1e-8 to 100 radii.

The angles of the series in `fsi.lubrication.bispherical`, which has the sources, follow from

    cosh al - 1 = q (2 b + q) / (2 a d),   cosh be - 1 = q (2 a + q) / (2 b d),   d = a + b + q

A sphere that a constant force F moves along the normal of a plane obeys `q' = F / (6 pi mu a lambda(s))`. F <
0 pushes it towards the plane, which it never reaches: q falls off like `exp(-t |F| / (6 pi mu a^2))`. In y =
ln s the time, in units of 6 pi mu a^2 / F, is the integral of `s lambda`, which is analytic for |Im y| < pi,
tends to 1 at small gaps and grows with y: Gauss's rule on panels gives it. Relative error of a
time: below 1e-12, but never less than 1e-15 of the unit; of a gap: about 1e-15 times the time in these units.
"""

from functools import cache

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike

from fsi.arrays import Array
from fsi.lubrication.bispherical import sum_common, sum_cross, sum_self
from fsi.lubrication.exact import bipolar_angle, gap_ratio
from fsi.lubrication.panels import NODES, PANEL, WEIGHTS

type Both = tuple[ArrayLike, ArrayLike]  # of the first sphere and of the second


def normal_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """F / V of a sphere moving along the normal of a plane: `6 pi mu a lambda(s)`, Brenner's lambda."""
    al = bipolar_angle(gap_ratio(gap, radius))
    return _scale(al, radius, viscosity) * sum_self(al, np.zeros_like(al))


def pair_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """Force on each of two equal spheres over their RELATIVE speed along the line of centres.

    Spheres approaching at speed V (each at V/2) need opposite forces of this times V.
    """
    force, _ = line_forces(gap, (radius, radius), viscosity, (0.5, -0.5))
    return force


def relative_resistance(gap: ArrayLike, radius: ArrayLike, other: ArrayLike, viscosity: ArrayLike) -> Array:
    """Force on each of two spheres over their RELATIVE speed along the line of centres, without net force.

    `-R_12 + C_1 C_2/(C_1 + C_2)`, C_i the force on sphere i when both move as one body: opposite forces need
    `C_1 V_1 + C_2 V_2 = 0`.
    """
    alone, other_alone = line_forces(gap, (radius, other), viscosity, (1.0, 1.0))
    cross, _ = line_forces(gap, (radius, other), viscosity, (0.0, 1.0))
    return alone * other_alone / (alone + other_alone) - cross


def line_forces(gap: ArrayLike, radii: Both, viscosity: ArrayLike, velocities: Both) -> tuple[Array, Array]:
    """(F_1, F_2) of two spheres of radii (a, b) with the velocities (V_1, V_2) along their line of centres.

    `F_i = C_i W + R_i1 (V_1 - W) + R_i2 (V_2 - W)`, where W is the velocity that both share, and C_i the
    resistance of the pair moving as one body: R_11 + R_12, which cancels at small gaps, is never formed.
    """
    a, b = (np.asarray(radius, dtype=np.float64) for radius in radii)
    s, t = gap_ratio(gap, a), gap_ratio(gap, b)
    al = bipolar_angle(s * (1.0 + 0.5 * t) / (1.0 + a / b + t))
    be = bipolar_angle(t * (1.0 + 0.5 * s) / (1.0 + b / a + s))
    v1, v2 = (np.asarray(velocity, dtype=np.float64) for velocity in velocities)
    shared = np.where(v1 * v2 > 0.0, np.sign(v1) * np.minimum(np.abs(v1), np.abs(v2)), 0.0)
    v1, v2 = v1 - shared, v2 - shared
    scale, cross = _scale(al, a, viscosity), sum_cross(al, be)
    force = scale * (sum_common(al, be) * shared + sum_self(al, be) * v1 + cross * v2)
    other_force = scale * (sum_common(be, al) * shared + cross * v1 + sum_self(be, al) * v2)
    return force, other_force


def concentric_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """F / V of a sphere at the centre of a spherical container of radius R = a + q, in any direction.

    `6 pi mu a (1 - l^5) / (1 - 9 l/4 + 5 l^3/2 - 9 l^5/4 + l^6)`, l = a/R: E. Cunningham, Proc. R. Soc. A 83
    (1910) 357; here with the powers of 1 - l = q/R taken out of both polynomials.
    """
    s = gap_ratio(gap, radius)
    film, ratio = s / (1.0 + s), 1.0 / (1.0 + s)
    numerator = 1.0 + ratio * (1.0 + ratio * (1.0 + ratio * (1.0 + ratio)))
    factor = numerator / (film**3 * (1.0 + ratio * (1.75 + ratio)))
    return _drag(radius, viscosity) * factor


def _drag(radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """6 pi mu a."""
    drag: Array = 6.0 * np.pi * np.asarray(viscosity, dtype=np.float64) * np.asarray(radius, dtype=np.float64)
    return drag


def _scale(al: Array, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """2 pi mu c, with c = a sinh al."""
    return _drag(radius, viscosity) * np.sinh(al) / 3.0


_LOWEST, _HIGHEST = -36.0, 16.0  # the range of y in which s lambda is interpolated
# Points pi i beside a range of half the width W = 26 leave polynomials of degree n an error of rho^-n with
# ln rho = arsinh(pi / W) = 0.12 (Trefethen 2008, SIAM Rev. 50:67): 300 come to 2e-16, and rounding beyond.
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
    return np.asarray(np.exp(y) * np.asarray(radius))


def _time_unit(radius: ArrayLike, viscosity: ArrayLike, force: ArrayLike) -> Array:
    """6 pi mu a^2 / F, signed like the force."""
    return np.asarray(_drag(radius, viscosity) * np.asarray(radius) / np.asarray(force))


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
        return np.asarray(normal_resistance(s, 1.0, 1.0) / (6.0 * np.pi * (1.0 + 1.0 / s)))

    return Chebyshev.interpolate(hump, _DEGREE, domain=[_LOWEST, _HIGHEST])


def _rise_time(y: Array, y0: Array) -> Array:
    """The integral of s lambda over y from y0 to y."""
    panels = max(1, int(np.ceil(np.max(np.abs(y - y0), initial=0.0) / PANEL)))
    half = (0.5 / panels) * (y - y0)
    centres = 2.0 * np.arange(panels) + 1.0
    t = y0[..., None] + half[..., None] * (centres[:, None] + NODES).ravel()
    return np.asarray(half * (_slope(t) @ np.tile(WEIGHTS, panels)))
