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

a symmetric, positive mobility. For equal discs del = y = 0: f = 4 pi mu s/(L + sinh L), and tau =
4 pi mu c^2 rho/(sinh L - tanh L). At small gaps, a_r = a b/(a + b), the resistances are sqrt2 pi mu
(a_r/D)^(1/2) and 4 sqrt2 pi mu a_r^2 (a_r/D)^(1/2), whatever a/b is: those of Reynolds' equation.

Source: derived here, in the coordinates of G. B. Jeffery, Proc. R. Soc. A 101 (1922) 169; the tests compare
it with the resolved flow, with Reynolds' limit, and with the closed forms beside a plane.
"""

import numpy as np
from numpy.typing import ArrayLike

from fsi.lubrication.exact import Array, gap_ratio


def sliding_resistance(gap: ArrayLike, radius: ArrayLike, other: ArrayLike, viscosity: ArrayLike) -> Array:
    """f / s where surfaces slide past each other without a couple at x; arguments broadcast."""
    slide, _, _, _ = _mobilities(gap, radius, other)
    return np.asarray(4.0 * np.pi * np.asarray(viscosity) / slide)


def rolling_resistance(gap: ArrayLike, radius: ArrayLike, other: ArrayLike, viscosity: ArrayLike) -> Array:
    """tau / rho where the surfaces roll on each other and do not slide, s = 0; arguments broadcast."""
    slide, coupling, roll, c = _mobilities(gap, radius, other)
    return np.asarray(4.0 * np.pi * np.asarray(viscosity) * c**2 / (roll - coupling**2 / slide))


def _mobilities(gap: ArrayLike, radius: ArrayLike, other: ArrayLike) -> tuple[Array, Array, Array, Array]:
    """The three of the equations above, and c; raises ValueError where the gap is not positive."""
    a, b = np.asarray(radius, dtype=np.float64), np.asarray(other, dtype=np.float64)
    D = gap_ratio(gap, a) * a
    d = a + b + D
    c = np.sqrt(D * (D + 2.0 * a + 2.0 * b) * (D + 2.0 * a) * (D + 2.0 * b)) / (2.0 * d)
    al, be = np.arcsinh(c / a), np.arcsinh(c / b)
    L, sinh = al + be, np.sinh(al + be)
    # (b sqrt(c^2 + a^2) - a sqrt(c^2 + b^2)) / (a + b), the middle of the arms, without its cancellation
    y = c * (b - a) / (b * np.hypot(c, a) + a * np.hypot(c, b))
    cosh, M2 = np.cosh(al - be), sinh * np.sinh(al - be)
    # sinh L (cosh del - 1 / cosh L), where 1 cancels
    M3 = 2.0 * sinh * (np.sinh(0.5 * (al - be)) ** 2 + np.sinh(0.5 * L) ** 2 / np.cosh(L))
    return L + sinh * cosh - 2.0 * y * M2 + y**2 * M3, y * M3 - M2, M3, c
