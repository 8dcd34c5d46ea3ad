"""Exact Stokes forces on discs beside a plane and on two discs, per unit length.

The plane is y = 0 with the fluid above it. `gap` is the distance q from surface to surface, `radius` is a,
`viscosity` is mu, `s = q/a`. Bipolar coordinates bring in

    cosh al = 1 + s           a disc and a plane
    cosh L  = 1 + q/a + q/b + q^2/(2 a b)   two discs of radii a and b

Signs are those of the whole project: y and V_y away from the plane, omega and T counterclockwise, F and T the
EXTERNAL load that the motion needs (the fluid exerts the opposite). Every argument may be an array; arrays
broadcast. Relative error: a few 1e-15 for every gap in double precision, since nothing here is a difference
of nearly equal numbers. Gaps and radii must be positive; others raise InputError.

Sources: D. J. Jeffrey and Y. Onishi, "The slow motion of a cylinder next to a plane wall", Q. J. Mech. Appl.
Math. 34 (1981) 129, for the plane; the pair follows in the same coordinates from two opposite stresslets
without net force (tests compare both with independent high-precision values).
"""

from math import factorial, sqrt

import numpy as np
from numpy.typing import ArrayLike

from fsi.arrays import Array
from fsi.errors import InputError


class NotPositiveError(InputError, ValueError):
    """A gap or a radius is not positive."""


# al cosh al - sinh al = sum_k 2k al^(2k+1) / (2k+1)!, all terms positive; nine give 16 digits up to al = 1.
_FILM_SERIES = np.array([0.0] + [2.0 * k / factorial(2 * k + 1) for k in range(1, 10)])
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(64)


def normal_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """F_y / V_y of a disc moving along the normal of the plane: `4 pi mu / (al - tanh al)`, no torque."""
    return 4.0 * np.pi * np.asarray(viscosity) / less_tanh(bipolar_angle(gap_ratio(gap, radius)))


def parallel_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """F_x / V_x of a disc moving along the plane without rotating: `4 pi mu / al`, no torque."""
    return 4.0 * np.pi * np.asarray(viscosity) / bipolar_angle(gap_ratio(gap, radius))


def rotation_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """T / omega of a disc turning in place: `4 pi mu a^2 coth al`, no force."""
    tanh = np.tanh(bipolar_angle(gap_ratio(gap, radius)))
    return 4.0 * np.pi * np.asarray(viscosity) * np.square(radius) / tanh


def held_in_shear(
    gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike, shear_rate: ArrayLike
) -> tuple[Array, Array]:
    """(F_x, T) that hold a disc at rest in the flow `u = gamma y e_x`.

    `F_x = -4 pi mu gamma a sinh al / al`: the flow pushes along +x. `T = 2 pi mu gamma a^2` at every gap: the
    flow turns the disc clockwise.
    """
    s = gap_ratio(gap, radius)
    stress = np.asarray(viscosity) * np.asarray(shear_rate)
    force = -4.0 * np.pi * stress * np.asarray(radius) * _sinh(s) / bipolar_angle(s)
    torque = 2.0 * np.pi * stress * np.square(radius) * np.ones_like(s)
    return force, torque


def free_in_shear(gap: ArrayLike, radius: ArrayLike, shear_rate: ArrayLike) -> tuple[Array, Array]:
    """(V_x, omega) of a disc without load in the flow `u = gamma y e_x`.

    `V_x = gamma a sinh al`, `omega = -(gamma / 2) tanh al`: the disc rolls clockwise.
    """
    s = gap_ratio(gap, radius)
    rate = np.asarray(shear_rate)
    return rate * np.asarray(radius) * _sinh(s), -0.5 * rate * _sinh(s) / (1.0 + s)


def pair_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """`relative_resistance` of equal discs, each moving at half the relative speed."""
    return relative_resistance(gap, radius, radius, viscosity)


def relative_resistance(gap: ArrayLike, radius: ArrayLike, other: ArrayLike, viscosity: ArrayLike) -> Array:
    """Force on each of two discs over their RELATIVE speed along the line of centres, `4 pi mu/(L - tanh L)`.

    The forces are opposite: the plane has no other walls, and without net force the flow decays at infinity.
    The stream function over c/(cosh xi - cos eta) is f(xi) sin eta, f = A cosh 2 xi + B sinh 2 xi + C xi + D,
    with f' = 0 and f the velocity on both discs. Such f may be shifted in xi, so that only the distance L of
    the discs in xi matters: f = k (xi - sinh 2 xi / (2 cosh L)) from -L/2 to L/2, F = 4 pi mu k. A disc of
    infinite radius is the plane, one of radius -R the wall of a round container, seen from inside.
    """
    s, t = gap_ratio(gap, radius), np.asarray(gap, dtype=np.float64) / np.asarray(other, dtype=np.float64)
    return 4.0 * np.pi * np.asarray(viscosity) / less_tanh(bipolar_angle(s + t + 0.5 * s * t))


def plane_lubrication(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """Leading term of `normal_resistance` at small gaps: `3 sqrt2 pi mu s^(-3/2)`; it lacks 21 s / 20."""
    return 3.0 * sqrt(2.0) * np.pi * np.asarray(viscosity) * gap_ratio(gap, radius) ** -1.5


def settling_time(
    gap: ArrayLike, start: ArrayLike, radius: ArrayLike, viscosity: ArrayLike, force: ArrayLike
) -> Array:
    """Time in which a disc goes from the gap `start` to `gap` under a constant force F_y, without inertia.

    `q' = F_y (al - tanh al) / (4 pi mu)`. A force towards the plane (F_y < 0) never closes the gap:
    `t ~ 12 pi mu a / (|F_y| sqrt(2 s))`. Negative where the disc was at `gap` before it was at `start`.
    """
    al, al0 = bipolar_angle(gap_ratio(gap, radius)), bipolar_angle(gap_ratio(start, radius))
    return _rise_time(al, al0) * _time_unit(radius, viscosity, force)


def settling_gap(
    time: ArrayLike, start: ArrayLike, radius: ArrayLike, viscosity: ArrayLike, force: ArrayLike
) -> Array:
    """Gap at `time` of a disc that leaves the gap `start` at t = 0: the inverse of `settling_time`.

    Newton's method in `x = 1/al`, in which the time is convex and decreasing: from any x left of the root it
    converges without overshoot. Such an x follows from the speed `al - tanh al < 2 sinh(al/2) = sqrt(2 s)`.
    """
    rise = np.asarray(time) / _time_unit(radius, viscosity, force)
    s0, rise = np.broadcast_arrays(gap_ratio(start, radius), rise)
    al0 = bipolar_angle(s0)
    al = bipolar_angle(np.square(np.sqrt(s0) + np.maximum(rise, 0.0) / np.sqrt(2.0)))
    for _ in range(100):
        step = (_rise_time(al, al0) - rise) * less_tanh(al) / (np.square(al) * np.sinh(al))
        al = al / (1.0 + al * step)
        if np.all(np.abs(al * step) < 1e-15):
            break
    return np.asarray(2.0 * np.square(np.sinh(0.5 * al)) * np.asarray(radius))


def gap_ratio(gap: ArrayLike, radius: ArrayLike) -> Array:
    """The ratio s = q/a. Raises NotPositiveError where it, q or a is not positive."""
    q, a = np.asarray(gap, dtype=np.float64), np.asarray(radius, dtype=np.float64)
    _require_positive("gap", q)
    _require_positive("radius", a)
    s = np.asarray(q / a)
    _require_positive("gap / radius", s)  # of an infinite radius it is not
    return s


def _require_positive(name: str, values: Array) -> None:
    if not np.all(values > 0.0):
        raise NotPositiveError(f"{name} = {np.min(values):g}: the exact laws need gap > 0 and radius > 0")


def bipolar_angle(s: ArrayLike) -> Array:
    """The angle al with cosh al = 1 + s, from `2 sinh^2(al/2) = s`."""
    return np.asarray(2.0 * np.arcsinh(np.sqrt(0.5 * np.asarray(s))))


def _sinh(s: Array) -> Array:
    """Gives sinh al = sqrt(s (2 + s)), with cosh al = 1 + s."""
    return np.sqrt(s * (2.0 + s))


def less_tanh(al: Array) -> Array:
    """Gives al - tanh al > 0; where that cancels, (al cosh al - sinh al) / cosh al by its series."""
    small = np.minimum(al, 1.0)
    series = small * np.polynomial.polynomial.polyval(np.square(small), _FILM_SERIES) / np.cosh(small)
    return np.where(al < 1.0, series, al - np.tanh(al))


def _time_unit(radius: ArrayLike, viscosity: ArrayLike, force: ArrayLike) -> Array:
    """4 pi mu a / F_y, signed like the force."""
    return np.asarray(4.0 * np.pi * np.asarray(viscosity) * np.asarray(radius) / np.asarray(force))


def _rise_time(al: Array, al0: Array) -> Array:
    """The integral of `ds / (al - tanh al) = sinh al dal / (al - tanh al)` from al0 to al.

    The pole 3/al^2 is integrated exactly. What remains is even and analytic up to al = 4.49 i, so 64 Gauss
    points give it to rounding for al up to 20 (gaps of 1e8 radii).
    """
    half = 0.5 * (al - al0)
    t = (0.5 * (al + al0))[..., None] + half[..., None] * _NODES
    regular = np.sinh(t) / less_tanh(t) - 3.0 / np.square(t)
    return np.asarray((al - al0) * (3.0 / (al * al0) + 0.5 * regular @ _WEIGHTS))
