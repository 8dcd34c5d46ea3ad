"""Exact Stokes forces on spheres that move along their line of centres, or along the normal of a plane.

`gap` is the distance q from surface to surface, `radius` a, `other` the second sphere's radius b, `viscosity`
mu, `s = q/a`. Velocities and forces count along one common direction of the line of centres (of a plane:
its normal, away from it); F is the EXTERNAL force that the motion needs (the fluid exerts the opposite).
Arguments may be arrays; arrays broadcast. Gaps must be positive; others raise ValueError. Relative error: a
few 1e-15, measured for gaps from 1e-8 to 100 radii.

The angles of the series in `fsi.lubrication.bispherical`, which has the sources, follow from

    cosh al - 1 = q (2 b + q) / (2 a d),   cosh be - 1 = q (2 a + q) / (2 b d),   d = a + b + q
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fsi.lubrication.bispherical import sum_common, sum_cross, sum_self
from fsi.lubrication.exact import gap_ratio

Array = NDArray[np.float64]
type Both = tuple[ArrayLike, ArrayLike]  # of the first sphere and of the second


def normal_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """F / V of a sphere moving along the normal of a plane: `6 pi mu a lambda(s)`, Brenner's lambda."""
    al = _angle(gap_ratio(gap, radius))
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
    al, be = _line_angles(gap, a, b)
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


def _angle(height: Array) -> Array:
    """The angle al with cosh al = 1 + height, from `2 sinh^2(al/2) = height`."""
    return 2.0 * np.arcsinh(np.sqrt(0.5 * height))


def _line_angles(gap: ArrayLike, a: Array, b: Array) -> tuple[Array, Array]:
    """The angles (al, be) of two spheres, of one shape."""
    s, t = gap_ratio(gap, a), gap_ratio(gap, b)
    return _angle(s * (1.0 + 0.5 * t) / (1.0 + a / b + t)), _angle(t * (1.0 + 0.5 * s) / (1.0 + b / a + s))


def _scale(al: Array, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """2 pi mu c, with c = a sinh al."""
    return _drag(radius, viscosity) * np.sinh(al) / 3.0
