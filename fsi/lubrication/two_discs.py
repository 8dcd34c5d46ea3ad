"""Exact resistances of two discs to sliding past each other and to rolling on each other, per unit length.

The discs, of radii a and b a gap D apart, are in unbounded fluid and without net load, so that a rigid motion
of both costs nothing; t is the direction across the line of centres, n x t = 1 with n from disc 2 to disc 1,
and d = a + b + D. What is left of six velocities, besides squeeze, is

    s = (V_1 - V_2).t - l_1 omega_1 - l_2 omega_2    the surfaces slide,  l_1 = a d/(a + b), l_2 = b d/(a + b)
    rho = omega_1 - omega_2                          the discs roll

and the loads of these are a force f t on disc 1 that acts at the point x where the arms l meet, with -f t on
disc 2, and a couple: tau on disc 1, -tau on disc 2.

In bipolar coordinates, c^2 = D (D + 2a + 2b) (D + 2a) (D + 2b) / (4 d^2), sinh al = c/a, sinh be = c/b,
L = al + be and del = al - be, the stream function over the metric is

    (a0 + c0 xi) cosh xi + (b0 + d0 xi) sinh xi + (a1 cosh 2 xi + b1 + c1 sinh 2 xi - c0 xi) cos eta

with one c0 in both places, or the pressure would not be single-valued. Terms with xi are the force f =
-4 pi mu d0 and the couple tau = 4 pi mu (c c0 + x d0). That it moves rigidly on both discs gives s and rho by
f and tau, with y = x/c:

    4 pi mu s     =  (M1 - 2 y M2 + y^2 M3) f + (y M3 - M2) tau/c       M1 = L + sinh L cosh del
    4 pi mu c rho =  (y M3 - M2) f + M3 tau/c                           M2 = sinh L sinh del
                                                                        M3 = sinh L cosh del - tanh L

a symmetric, positive mobility. With a_r = a b/(a + b), s = D/a_r, k = a b/(a + b)^2 and h = cosh L - 1 = s +
k s^2/2 everything in it follows from L and k: y = sqrt(1 - 4k) tanh(L/2), c = a_r sinh L/(1 + k s), and

    1/(mobility)   f/s = 4 pi mu / A,                       A = L + (1 + 4 k h) tanh L
    1/(inverse)    tau/rho = 4 pi mu a_r^2 A / (tanh L ((1 - 2k) L + 2 k sinh L))

in which all terms are positive. For equal discs k = 1/4: f = 4 pi mu s/(L + sinh L). Without a couple discs
that slide roll by rho = -g s, and the power of both rates is

    (f/s) s^2 + (tau/rho) (rho + g s)^2,                    g = (b - a)/(a b) (1 + k D/a_r) tanh L / A

At small gaps g is (1/a - 1/b)/2, and the resistances are sqrt2 pi mu (a_r/D)^(1/2) and 4 sqrt2 pi mu a_r^2
(a_r/D)^(1/2), whatever a/b is: those of Reynolds' equation. Relative error: a few 1e-16 for every gap
and all radii.

Source: derived here, in the coordinates of G. B. Jeffery, Proc. R. Soc. A 101 (1922) 169; the tests compare
it with the mobility above, with the resolved flow, with Reynolds' limit, and with the closed forms beside a
plane.
"""

import numpy as np
from numpy.typing import ArrayLike

from fsi.arrays import Array
from fsi.lubrication.exact import bipolar_angle, gap_ratio


def sliding_resistance(gap: ArrayLike, radius: ArrayLike, other: ArrayLike, viscosity: ArrayLike) -> Array:
    """f / s where surfaces slide past each other without a couple at x; arguments broadcast.

    Raises ValueError where the gap is not positive.
    """
    a_r, k = _reduced(radius, other)
    return np.asarray(np.asarray(viscosity) * sliding(gap_ratio(gap, a_r), k))


def rolling_resistance(gap: ArrayLike, radius: ArrayLike, other: ArrayLike, viscosity: ArrayLike) -> Array:
    """tau / rho where the surfaces roll on each other and do not slide, s = 0; arguments broadcast.

    Raises ValueError where the gap is not positive.
    """
    a_r, k = _reduced(radius, other)
    return np.asarray(np.asarray(viscosity) * a_r**2 * rolling(gap_ratio(gap, a_r), k))


def rolling_of_sliding(gap: ArrayLike, radius: ArrayLike, other: ArrayLike) -> Array:
    """g, by which discs of radii a and b roll back where they slide without a couple; arguments broadcast.

    Raises ValueError where the gap is not positive.
    """
    a, b = np.asarray(radius, dtype=np.float64), np.asarray(other, dtype=np.float64)
    a_r, k = _reduced(a, b)
    s = gap_ratio(gap, a_r)
    h, L = _angle(s, k)
    return np.asarray((b - a) / (a * b) * (1.0 + k * s) * np.tanh(L) / _of_sliding(h, L, k))


def sliding(s: Array, k: ArrayLike) -> Array:
    """f / s over mu, of s and k."""
    h, L = _angle(s, k)
    return np.asarray(4.0 * np.pi / _of_sliding(h, L, k))


def rolling(s: Array, k: ArrayLike) -> Array:
    """tau / rho over mu a_r^2, of s and k."""
    h, L = _angle(s, k)
    k, tanh = np.asarray(k), np.tanh(L)
    A = _of_sliding(h, L, k)
    # sinh L = (1 + h) tanh L
    return np.asarray(4.0 * np.pi * A / (tanh * ((1.0 - 2.0 * k) * L + 2.0 * k * (1.0 + h) * tanh)))


def _angle(s: Array, k: ArrayLike) -> tuple[Array, Array]:
    """h = cosh L - 1 and L."""
    h: Array = s * (1.0 + 0.5 * np.asarray(k) * s)
    return h, bipolar_angle(h)


def _of_sliding(h: Array, L: Array, k: ArrayLike) -> Array:
    """A of both resistances."""
    return np.asarray(L + (1.0 + 4.0 * np.asarray(k) * h) * np.tanh(L))


def _reduced(radius: ArrayLike, other: ArrayLike) -> tuple[Array, Array]:
    """a_r and k of radii a and b."""
    a, b = np.asarray(radius, dtype=np.float64), np.asarray(other, dtype=np.float64)
    return a * b / (a + b), a * b / (a + b) ** 2
