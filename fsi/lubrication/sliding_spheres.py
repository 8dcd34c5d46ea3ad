"""How two spheres, or a sphere and a plane, resist sliding and rolling on each other, at small gaps.

Of two spheres without net force and torque, in unbounded fluid, with the rates of `fsi.lubrication.sliding`
and the loads of these rates alone,

    (slide, roll) = G M G^T f,      G the rows of both rates, M the mobility of `fsi.lubrication.two_spheres`,

the inverse of G M G^T has the resistances S of sliding, R of rolling and their coupling - C: the power is
S slide^2 - 2 C slide roll + R roll^2. Beside a plane slide and roll are V and a omega of a sphere that moves
and turns in place, and C is the B of `fsi.lubrication.sphere_beside_plane`. All are, with s the gap over a_r,

    mu a_r (c_1 ln(1/s) + c_2 + c_3 s ln(1/s) + c_4 s + ...)

with c_1 by Reynolds' equation (`fsi.lubrication.expansions`; D. J. Jeffrey and Y. Onishi, J. Fluid Mech. 139
(1984) 261; A. J. Goldman, R. G. Cox and H. Brenner, Chem. Eng. Sci. 22 (1967) 637), and here the next seven
coefficients fitted to the exact functions at gaps from 0.03 to 1.5 a_r. Relative error, measured at gaps
from 0.01 to 1.5 a_r, for ratios of the radii up to 5: 1e-5 of S and R, 1e-4 of the largest C.
"""

from functools import cache
from math import inf, pi

import numpy as np

from fsi.arrays import Array
from fsi.lubrication import sphere_beside_plane
from fsi.lubrication.expansions import Mode, basis, expansion
from fsi.lubrication.profiles import Series, Term
from fsi.lubrication.sliding import arms
from fsi.lubrication.two_spheres import pair_matrix

MOST_UNEQUAL = 5.0  # beyond, narrow gaps take many multipoles: minutes, and more than `two_spheres` has
_GAPS = np.geomspace(0.03, 1.5, 14)
_TERMS = 7  # after the logarithm; the last ones are small there


def resistances(gap: float, ratio: float) -> Array:
    """(S, -C; -C, R), (2, 2), of two spheres of radii 1 + 1/ratio and 1 + ratio, a_r = 1, mu = 1."""
    a, b = 1.0 + 1.0 / ratio, 1.0 + ratio
    d = a + b + gap
    mobility = np.linalg.inv(pair_matrix(np.array([[0.0, 0.0, d], [0.0, 0.0, 0.0]]), (a, b), 1.0))
    (arm, arm_other), g = arms(a, b, gap), 0.5 * (1.0 / a - 1.0 / b)
    rates = np.zeros((2, 2, 6))  # along x, turning about y: n = z leads from the second sphere to the first
    rates[0, :, 0], rates[0, :, 4] = (1.0, -1.0), (-arm, -arm_other)
    rates[1, :, 4] = 1.0, -1.0
    rates[1] += g * rates[0]
    G = rates.reshape(2, 12)
    return np.asarray(np.linalg.inv(G @ mobility @ G.T))


@cache
def profiles(ratio: float) -> dict[Mode, Series]:
    """S and R of two spheres over mu a_r. Raises ValueError: their radii differ by more than MOST_UNEQUAL."""
    exact = _exact(ratio)
    modes: tuple[Mode, Mode] = ("shear", "rotation")
    return {
        mode: _fitted(exact[:, k, k], expansion("spheres", mode, ratio, 1).coefficients[0])
        for k, mode in enumerate(modes)
    }


@cache
def coupling(ratio: float) -> Series:
    """C over mu a_r where the first sphere is the smaller one; ratio: infinite beside a plane.

    Raises ValueError as `profiles`.
    """
    if ratio == inf:
        return _fitted(np.asarray(sphere_beside_plane.coupling_resistance(_GAPS, 1.0, 1.0)), 0.8 * pi)
    return _fitted(-_exact(ratio)[:, 0, 1], 0.0)


@cache
def _exact(ratio: float) -> Array:
    if not ratio <= MOST_UNEQUAL:
        raise ValueError(f"radii of ratio {ratio:g}: sliding spheres are known here up to {MOST_UNEQUAL:g}")
    return np.array([resistances(float(gap), ratio) for gap in _GAPS])


def _fitted(values: Array, leading: float) -> Series:
    """The expansion through values at _GAPS, by least squares of errors over the largest of them."""
    log, *terms = basis("spheres", "shear")[: 1 + _TERMS]
    assert log == Term(0.0, True)
    columns = np.column_stack([term.value(_GAPS) for term in terms])
    found, *_ = np.linalg.lstsq(columns, values - leading * log.value(_GAPS))
    return Series((log, *terms), (leading, *found.tolist()))
