"""Exact Stokes forces and torques on a sphere that moves along a plane, turns beside it, or is held in shear.

The plane is y = 0 with the fluid above it; `gap` is the distance q from surface to surface, `radius` a,
`viscosity` mu, `s = q/a`, h = a + q. Signs are those of the planar module: x along the plane, omega and T
counterclockwise in the (x, y) plane, F and T the EXTERNAL load that the motion needs. Unlike a disc's, a
sphere's translation and rotation are coupled:

    F_x = A V + B omega,   T = B V + C omega       A, B, C: parallel_, coupling_, rotation_resistance

Arguments may be arrays; arrays broadcast. Gaps must be at least 1e-10 a (2e6 modes take seconds there);
others raise ValueError. Relative error, measured for gaps from 1e-6 to 10 radii: 1e-13 for A and C, 1e-12 for
the force and 1e-11 for the torque in shear, 1e-10 for B. Far away B falls off like (a/h)^4, as a difference
of numbers that do not: up to 100 radii its absolute error is 1e-14 of 8 pi mu a^2.

The solution on the sphere xi = al of bispherical coordinates, cosh al = 1 + s, is due to M. E. O'Neill,
Mathematika 11 (1964) 67, and W. R. Dean and M. E. O'Neill, Mathematika 10 (1963) 13; the asymptotics to A. J.
Goldman, R. G. Cox and H. Brenner, Chem. Eng. Sci. 22 (1967) 637 and 653. The velocity is x p/(2 mu) + u with
u harmonic; no-slip gives all its coefficients in terms of the A_n of u_y, and div = 0 gives the A_n:

    z = (n + 1/2) al,   k_n = (n + 1/2) coth z - coth al
    a_n = (2n - 1) k_(n-1) - (2n - 3) k_n,   b_n = (2n + 5) k_n - (2n + 3) k_(n+1)
    a_n ((n-1)/(2n-1) A_(n-1) - n/(2n+1) A_n) - b_n ((n+1)/(2n+1) A_n - (n+2)/(2n+3) A_(n+1)) = r_n
    E_n = k_n ((n-1) n/(2n-1) A_(n-1) - (n+1) (n+2)/(2n+3) A_(n+1)) + e_n
    F_x = 2 sqrt2 pi mu c sum_n E_n,   c = a sinh al
    T = -2 sqrt2 pi mu c^2 sum_n ((2n + 1 - coth al) E_n - 2 n (n+1) A_n)

where e_n and r_n come from the motion of the sphere.
"""

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import ArrayLike

from fsi.arrays import Array
from fsi.lubrication.exact import bipolar_angle, gap_ratio, less_tanh

_SMALLEST = 1e-10
_DECAY = 22.0  # modes up to z = 22: the terms fall off like e^(-2 z)


def parallel_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """A = F_x / V_x of a sphere moving along the plane without rotating."""
    return 6.0 * _moment(radius, viscosity, 1) * _factors(gap, radius)[0]


def coupling_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """B = T / V_x of a sphere moving without rotating = F_x / omega of one turning in place; positive.

    The plane makes a sphere that moves along +x roll forwards, clockwise; this torque keeps it from that.
    """
    return 8.0 * _moment(radius, viscosity, 2) * _factors(gap, radius)[1]


def rotation_resistance(gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike) -> Array:
    """C = T / omega of a sphere turning in place about an axis along the plane."""
    return 8.0 * _moment(radius, viscosity, 3) * _factors(gap, radius)[2]


def held_in_shear(
    gap: ArrayLike, radius: ArrayLike, viscosity: ArrayLike, shear_rate: ArrayLike
) -> tuple[Array, Array]:
    """(F_x, T) that hold a sphere at rest in the flow `u = gamma y e_x`.

    The flow pushes along +x and turns clockwise: F_x is negative, T positive.
    """
    factors = _factors(gap, radius)
    a, rate = np.asarray(radius), np.asarray(shear_rate)
    force = -6.0 * _moment(radius, viscosity, 1) * (a + np.asarray(gap)) * rate * factors[3]
    return force, 4.0 * _moment(radius, viscosity, 3) * rate * factors[4]


def free_in_shear(gap: ArrayLike, radius: ArrayLike, shear_rate: ArrayLike) -> tuple[Array, Array]:
    """(V_x, omega) of a sphere without load in the flow `u = gamma y e_x`."""
    A, B, C = (f(gap, radius, 1.0) for f in (parallel_resistance, coupling_resistance, rotation_resistance))
    force, torque = held_in_shear(gap, radius, 1.0, shear_rate)
    determinant = A * C - B * B
    return (B * torque - C * force) / determinant, (B * force - A * torque) / determinant


def _moment(radius: ArrayLike, viscosity: ArrayLike, power: int) -> Array:
    """pi mu a^power."""
    return np.asarray(np.pi * np.asarray(viscosity) * np.asarray(radius, dtype=np.float64) ** power)


def _factors(gap: ArrayLike, radius: ArrayLike) -> tuple[Array, ...]:
    """The five factors of `_solve`. Raises ValueError where the gap is too small."""
    s = gap_ratio(gap, radius)
    if not np.all(s >= _SMALLEST):
        raise ValueError(f"gap / radius = {np.min(s)}: need at least {_SMALLEST}; below it use expansions")
    factors = np.array([_solve(float(x)) for x in s.ravel()]).T
    return tuple(factor.reshape(s.shape) for factor in factors)


def _solve(s: float) -> Array:
    """A, B, C, the force and the torque in shear, over what they are (B: could be) far from the plane.

    That is 6 pi mu a, 8 pi mu a^2, 8 pi mu a^3, -6 pi mu a h gamma and 4 pi mu a^3 gamma. B is taken from the
    force on the turning sphere, which loses fewer digits than the torque on the moving one.
    """
    al = float(bipolar_angle(s))
    n = np.arange(int(_DECAY / al) + 6.0)
    e, r = _motions(n, al)
    A = _coefficients(n, al, r)
    k = _k(n, al)[:, None]
    below = np.vstack([np.zeros((1, 3)), A[:-1]])
    above = np.vstack([A[1:], np.zeros((1, 3))])
    n = n[:, None]
    E = k * ((n - 1.0) * n / (2.0 * n - 1.0) * below - (n + 1.0) * (n + 2.0) / (2.0 * n + 3.0) * above) + e
    c = np.sinh(al)
    force = 2.0 * np.sqrt(2.0) * c * np.sum(E, axis=0)
    moment = (2.0 * n + 1.0 - 1.0 / np.tanh(al)) * E - 2.0 * n * (n + 1.0) * A
    torque = 2.0 * np.sqrt(2.0) * c * c * np.sum(moment, axis=0)
    in_shear = c * force[2] / (6.0 * (1.0 + s)), c * torque[2] / 4.0
    return np.array([force[0] / 6.0, -c * force[1] / 8.0, c * torque[1] / 8.0, *in_shear])


def _coefficients(n: Array, al: float, r: Array) -> Array:
    """A_n, shape (N, 3), from the tridiagonal system; A_0 = 0."""
    k, i = _k(np.append(n, n[-1] + 1.0), al), n[1:]
    a = (2.0 * i - 1.0) * k[:-2] - (2.0 * i - 3.0) * k[1:-1]
    b = (2.0 * i + 5.0) * k[1:-1] - (2.0 * i + 3.0) * k[2:]
    bands = np.zeros((3, len(i)))
    bands[0, 1:] = (b * (i + 2.0) / (2.0 * i + 3.0))[:-1]
    bands[1] = -(a * i + b * (i + 1.0)) / (2.0 * i + 1.0)
    bands[2, :-1] = (a * (i - 1.0) / (2.0 * i - 1.0))[1:]
    return np.vstack([np.zeros((1, 3)), scipy.linalg.solve_banded((1, 1), bands, r)])


def _k(n: Array, al: float) -> Array:
    """k_n = (n + 1/2) coth z - coth al, from `x coth x - 1 = (x - tanh x) / tanh x`."""
    z = (n + 0.5) * al
    film: Array = less_tanh(z) / np.tanh(z) - less_tanh(np.asarray(al)) / np.tanh(al)
    return film / al


def _motions(n: Array, al: float) -> tuple[Array, Array]:
    """(e_n, r_n) of three motions, shapes (N, 3) and (N - 1, 3): the latter starts at n = 1.

    The sphere moves along x at speed 1; turns clockwise, `((y - h)/c, -x/c)`; has the velocity `(y/c, 0)` of
    a shear flow. Differences of coth at neighbouring modes in r_n are worked out by the addition theorems.
    """
    m, z, coth = 2.0 * n + 1.0, (n + 0.5) * al, 1.0 / np.tanh(al)
    y = 2.0 / np.expm1(2.0 * z)  # coth z - 1
    chi = (m + 2.0 * coth) / ((m - 2.0) * (m + 2.0))
    e = np.sqrt(2.0) * np.column_stack([2.0 * y, y * (m + chi), 2.0 * m * y])

    m, z, y = m[1:], z[1:], y[1:]
    sinh, cosh, product = np.sinh(z), np.cosh(z), np.sinh(z - al) * np.sinh(z + al)
    # (m - 2)/sinh(z - al) -+ (m + 2)/sinh(z + al)
    less = 4.0 * np.cosh(al) * cosh * (less_tanh(z) - 0.5 * m * less_tanh(np.asarray(al))) / product
    plus = 2.0 * (m * sinh * np.cosh(al) - 2.0 * cosh * np.sinh(al)) / product
    moving = -2.0 * np.sinh(al) ** 2 * cosh / (sinh * product)
    turning = (np.cosh(al) * less - np.sinh(al) * plus) / (m * sinh)
    turning -= 8.0 * (2.0 + coth * m) * y / (m * (m - 2.0) * (m + 2.0))
    shearing = -np.sinh(al) * less / sinh
    return e, np.sqrt(2.0) * np.column_stack([moving, turning, shearing])
