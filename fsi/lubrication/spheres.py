"""Exact Stokes forces on spheres that move along their line of centres, or along the normal of a plane.

`gap` is the distance q from surface to surface, `radius` a, `other` the second sphere's radius b, `viscosity`
mu, `s = q/a`. Velocities and forces count along one common direction of the line of centres (of a plane:
its normal, away from it); F is the EXTERNAL force that the motion needs (the fluid exerts the opposite).
Arguments may be arrays; arrays broadcast. Gaps must be positive; others raise ValueError. Relative error below
1e-13 for gaps from 1e-14 to 1e6 radii.

In bispherical coordinates the spheres are xi = al and xi = -be,

    cosh al - 1 = q (2 b + q) / (2 a d),   cosh be - 1 = q (2 a + q) / (2 b d),   d = a + b + q,

and be = 0 is a plane. The stream function is a sum of modes n = 1, 2, ..., each of four exponentials; no-slip
gives four equations a mode. Solved in closed form, with m = 2n + 1, th = al + be, c = a sinh al,

    R_ij = 2 pi mu c sum_n (m^2 - 1)/(m^2 - 4) N_ij / D,     D = 4 sinh^2(m th/2) - m^2 sinh^2 th
    N_11 = e^(m be) (2 + m sinh 2al + m^2 sinh^2 al) - e^(-m al) (2 - m sinh 2be + m^2 sinh^2 be)
    N_12 = -2 (1 - e^(-m th)) - m (sinh 2al + sinh 2be) - m^2 sinh^2 th - m^3 sinh al sinh be sinh th

and N_22 is N_11 with al and be exchanged. These reduce to the series of H. Brenner (Chem. Eng. Sci. 16 (1961)
242) at be = 0, of M. Stimson and G. B. Jeffery (Proc. R. Soc. A 111 (1926) 110) and A. D. Maude (Br. J. Appl. Phys.
12 (1961) 293) for equal spheres; tests compare them with those and with the 4 x 4 systems. Differences of
nearly equal numbers are removed with `tail(z) = e^z - 1 - z - z^2/2`.
"""

from __future__ import annotations

from math import factorial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fsi.lubrication.mode_sums import mode_rule

Array = NDArray[np.float64]

# tail(z) = z^3 sum_k z^k / (k + 3)!; sixteen terms give 16 digits up to |z| = 1.
_TAIL_SERIES = np.array([1.0 / factorial(k + 3) for k in range(16)])


def normal_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """F / V of a sphere moving along the normal of a plane: `6 pi mu a lambda(s)`, Brenner's lambda."""
    al = _angle(_ratio(gap, radius))
    return _scale(al, radius, viscosity) * _sum_self(al, np.zeros_like(al))


def pair_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """Force on each of two equal spheres over their RELATIVE speed along the line of centres.

    Spheres approaching at speed V (each at V/2) need opposite forces of this times V.
    """
    force, _ = line_forces(gap, radius, radius, viscosity, 0.5, -0.5)
    return force


def line_forces(
    gap: ArrayLike,
    radius: ArrayLike,
    other: ArrayLike,
    viscosity: ArrayLike,
    velocity: ArrayLike,
    other_velocity: ArrayLike,
) -> tuple[Array, Array]:
    """(F_1, F_2) of two spheres with the given velocities V_1, V_2 along their line of centres.

    `F_i = C_i W + R_i1 (V_1 - W) + R_i2 (V_2 - W)`, where W is the velocity that both share, and C_i the
    resistance of the pair moving as one body: R_11 + R_12, which cancels at small gaps, is never formed.
    """
    a, b = np.asarray(radius, dtype=np.float64), np.asarray(other, dtype=np.float64)
    al, be = _line_angles(gap, a, b)
    v1, v2 = np.asarray(velocity, dtype=np.float64), np.asarray(other_velocity, dtype=np.float64)
    shared = np.where(v1 * v2 > 0.0, np.sign(v1) * np.minimum(np.abs(v1), np.abs(v2)), 0.0)
    v1, v2 = v1 - shared, v2 - shared
    scale, cross = _scale(al, a, viscosity), _sum_cross(al, be)
    force = scale * (_sum_common(al, be) * shared + _sum_self(al, be) * v1 + cross * v2)
    other_force = scale * (_sum_common(be, al) * shared + cross * v1 + _sum_self(be, al) * v2)
    return force, other_force


def concentric_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """F / V of a sphere at the centre of a spherical container of radius R = a + q, in any direction.

    `6 pi mu a (1 - l^5) / (1 - 9 l/4 + 5 l^3/2 - 9 l^5/4 + l^6)`, l = a/R: E. Cunningham, Proc. R. Soc. A 83 (1910)
    357; here without the common factor 1 - l of both, which is q/R.
    """
    film, ratio = _film(gap, radius)
    numerator = 1.0 + ratio * (1.0 + ratio * (1.0 + ratio * (1.0 + ratio)))
    factor = numerator / (film**3 * (1.0 + ratio * (1.75 + ratio)))
    return 6.0 * np.pi * np.asarray(viscosity) * np.asarray(radius) * factor


def concentric_rotation_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """T / omega of a sphere turning at the centre of a spherical container: `8 pi mu a^3 / (1 - l^3)`."""
    film, ratio = _film(gap, radius)
    factor = 1.0 / (film * (1.0 + ratio * (1.0 + ratio)))
    return 8.0 * np.pi * np.asarray(viscosity) * np.asarray(radius) ** 3 * factor


def plane_lubrication(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """Leading term of `normal_resistance` at small gaps: `6 pi mu a^2 / q`; 1.9 % too small at s = 0.01."""
    return plane_expansion(gap, radius, viscosity, 1)


def plane_expansion(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike, terms: int) -> Array:
    """The first 1 to 5 terms of `normal_resistance` at small gaps, in the order

    `6 pi mu a (1/s + ln(1/s)/5 + 0.97128 + s ln(1/s)/21 + 0.16702 s)`; what follows is O(s^2 ln s).
    """
    s = _ratio(gap, radius)
    series = (1.0 / s, -np.log(s) / 5.0, 0.97127993103572, -s * np.log(s) / 21.0, 0.16701700481 * s)
    return 6.0 * np.pi * np.asarray(viscosity) * np.asarray(radius) * sum(series[:terms])


def line_lubrication(gap: ArrayLike, radius: ArrayLike, other: ArrayLike, viscosity: ArrayLike) -> Array:
    """Leading term at small gaps of the force on each of two spheres over their relative speed.

    `6 pi mu (a b / (a + b))^2 / q`; for equal spheres `(3/2) pi mu a^2 / q`.
    """
    a, b = np.asarray(radius, dtype=np.float64), np.asarray(other, dtype=np.float64)
    reduced = a * b / (a + b)
    return 6.0 * np.pi * np.asarray(viscosity) * reduced / _ratio(gap, reduced)


def pair_expansion(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike, terms: int) -> Array:
    """The first 1 to 4 terms of `pair_resistance` at small gaps, in the order

    `3 pi mu a (1/(2s) + (9/20) ln(1/s) + 1.34558 + (3/56) s ln(1/s))`; what follows is O(s).
    """
    s = _ratio(gap, radius)
    series = (0.5 / s, -0.45 * np.log(s), 1.34558019978, -3.0 / 56.0 * s * np.log(s))
    return 3.0 * np.pi * np.asarray(viscosity) * np.asarray(radius) * sum(series[:terms])


def _ratio(gap: ArrayLike, radius: ArrayLike) -> Array:
    """The ratio s = q/a; raises ValueError where it is not positive."""
    s = np.asarray(gap, dtype=np.float64) / np.asarray(radius, dtype=np.float64)
    if not np.all(s > 0.0):
        raise ValueError(f"gap / radius = {np.min(s)}: the exact laws need gap > 0 and radius > 0")
    return s


def _film(gap: ArrayLike, radius: ArrayLike) -> tuple[Array, Array]:
    """(q/R, a/R) of the container of radius R = a + q."""
    s = _ratio(gap, radius)
    return s / (1.0 + s), 1.0 / (1.0 + s)


def _angle(height: Array) -> Array:
    """The angle al with cosh al = 1 + height, from `2 sinh^2(al/2) = height`."""
    return 2.0 * np.arcsinh(np.sqrt(0.5 * height))


def _line_angles(gap: ArrayLike, a: Array, b: Array) -> tuple[Array, Array]:
    """The angles (al, be) of two spheres, of one shape."""
    s, t = _ratio(gap, a), _ratio(gap, b)
    distance = np.asarray(gap) + a + b
    al, be = _angle(s * (b + 0.5 * gap) / distance), _angle(t * (a + 0.5 * gap) / distance)
    return tuple(np.broadcast_arrays(al, be))


def _scale(al: Array, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """2 pi mu c, with c = a sinh al."""
    return 2.0 * np.pi * np.asarray(viscosity) * np.asarray(radius) * np.sinh(al)


def _sum_self(al: Array, be: Array) -> Array:
    """The sum of R_11."""
    m, weight = _modes(al)
    al, be = al[..., None], be[..., None]
    gone = np.exp(-m * (al + be))
    numerator = (
        -2.0 * np.expm1(-m * (al + be))
        + m * (np.sinh(2.0 * al) + gone * np.sinh(2.0 * be))
        + m**2 * (np.sinh(al) ** 2 - gone * np.sinh(be) ** 2)
    )
    total: Array = (np.exp(-m * al) * numerator / _denominator(m, al + be)) @ weight
    return total


def _sum_cross(al: Array, be: Array) -> Array:
    """The sum of R_12 = R_21."""
    m, weight = _modes(al + be)
    al, be = al[..., None], be[..., None]
    th = al + be
    numerator = (
        -2.0 * np.expm1(-m * th)
        + m * (np.sinh(2.0 * al) + np.sinh(2.0 * be))
        + (m * np.sinh(th)) ** 2
        + m**3 * np.sinh(al) * np.sinh(be) * np.sinh(th)
    )
    total: Array = -(np.exp(-m * th) * numerator / _denominator(m, th)) @ weight
    return total


def _sum_common(al: Array, be: Array) -> Array:
    """The sum of R_11 + R_12, which is of fourth order in m al, m be where R_11 is of first.

    `planar` is what is left when every sinh is its argument; `curved` is the rest.
    """
    m, weight = _modes(al)
    al, be = al[..., None], be[..., None]
    th = al + be
    x, y, z = m * al, m * be, m * th
    gone, left = np.exp(-z), np.exp(-x)
    planar = (2.0 * y - y**2) * _tail(-x) - (2.0 * y + y**2) * _tail(-z) - 0.5 * (y * z) ** 2
    planar = gone * planar + (2.0 * x + x**2 - 2.0 * np.expm1(-z)) * _tail(y, z)
    product = (
        _less_argument(al) * np.sinh(be) * np.sinh(th)
        + al * _less_argument(be) * np.sinh(th)
        + al * be * _less_argument(th)
    )
    curved = (
        -left * np.expm1(-y) * m * _less_argument(2.0 * al)
        + gone * np.expm1(-x) * m * _less_argument(2.0 * be)
        + m**2 * (left * _less_square(al) - gone * (left * _less_square(be) + _less_square(th)))
        - gone * m**3 * product
    )
    total: Array = ((planar + curved) / _denominator(m, th)) @ weight
    return total


def _modes(angle: Array) -> tuple[Array, Array]:
    """m = 2n + 1 and the weights (m^2 - 1)/(m^2 - 4), times those of the rule that sums the modes."""
    n, weight = mode_rule(float(np.min(angle)))
    m = 2.0 * n + 1.0
    return m, weight * (m**2 - 1.0) / (m**2 - 4.0)


def _denominator(m: Array, th: Array) -> Array:
    """e^(-m th) D, as the product of its factors: the smaller one by the tails, its terms of first order cancel."""
    half = 0.5 * m * th
    decay = np.exp(-half)
    minus = 2.0 * _less_argument(half, half) - decay * m * _less_argument(th)
    plus = -np.expm1(-2.0 * half) + decay * m * np.sinh(th)
    return minus * plus


def _tail(z: Array, shift: ArrayLike = 0.0) -> Array:
    """e^(-shift) (e^z - 1 - z - z^2/2), by its series where it is small; shift keeps large z from overflow."""
    small = np.clip(z, -1.0, 1.0)
    series = small**3 * np.polynomial.polynomial.polyval(small, _TAIL_SERIES)
    decay = np.exp(-np.asarray(shift))
    return np.where(np.abs(z) < 1.0, decay * series, np.exp(z - shift) - decay * (1.0 + z + 0.5 * z**2))


def _less_argument(z: Array, shift: ArrayLike = 0.0) -> Array:
    """e^(-shift) (sinh z - z) for z >= 0."""
    return 0.5 * (_tail(z, shift) - _tail(-z, shift))


def _less_square(z: Array) -> Array:
    """sinh^2 z - z^2."""
    return _less_argument(z) * (np.sinh(z) + z)
