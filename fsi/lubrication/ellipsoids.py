"""Ellipsoids in unbounded fluid: what resists their motion, and how they turn in a linear flow.

With the half axes a_1, a_2, a_3, and the integrals from 0 to infinity, Delta^2 = prod (a_k^2 + s),

    chi = int ds / Delta = 2 R_F(a_1^2, a_2^2, a_3^2)
    alpha_i = int ds / ((a_i^2 + s) Delta) = 2/3 R_D(a_j^2, a_k^2, a_i^2)

(R_F and R_D of Carlson, DLMF 19.16) the loads that motions at V_i along and omega_i about the axis i need are

    F_i = 16 pi mu V_i / (chi + a_i^2 alpha_i)                                      (Oberbeck 1876)
    T_i = 16 pi mu (a_j^2 + a_k^2) omega_i / (3 (a_j^2 alpha_j + a_k^2 alpha_k))    (Jeffery 1922)

F and T are EXTERNAL loads. Relative error: some 1e-15.
"""

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array


def _integrals(axes: Array) -> tuple[float, Array]:
    """chi, and alpha (3,)."""
    a, b, c = np.square(axes)
    R_D = scipy.special.elliprd
    alpha = 2.0 / 3.0 * np.array([R_D(b, c, a), R_D(c, a, b), R_D(a, b, c)])
    return 2.0 * float(scipy.special.elliprf(a, b, c)), alpha


def translation_resistance(axes: Array, viscosity: float) -> Array:
    """F_i / V_i of an ellipsoid with the half axes (3,), (3,)."""
    chi, alpha = _integrals(axes)
    resistance: Array = 16.0 * np.pi * viscosity / (chi + np.square(axes) * alpha)
    return resistance


def rotation_resistance(axes: Array, viscosity: float) -> Array:
    """T_i / omega_i, (3,)."""
    squares, (_, alpha) = np.square(axes), _integrals(axes)
    both, weighted = squares.sum() - squares, squares @ alpha - squares * alpha
    resistance: Array = 16.0 / 3.0 * np.pi * viscosity * both / weighted
    return resistance


def free_rotation(axes: Array, gradient: Array) -> Array:
    """omega (3,) of a free ellipsoid in the flow u = G x, G (3, 3) in its own axes (Jeffery 1922).

    omega_i = curl_i / 2 + (a_j^2 - a_k^2) / (a_j^2 + a_k^2) E_jk,  E the symmetric part, i j k cyclic.
    """
    omega, squares = np.empty(3), np.square(axes)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        flat = (squares[j] - squares[k]) / (squares[j] + squares[k])
        omega[i] = 0.5 * (gradient[k, j] - gradient[j, k]) + 0.5 * flat * (gradient[j, k] + gradient[k, j])
    return omega


def spheroid_axis(ratio: float, gradient: Array, axis: Array, t: float) -> Array:
    """Where the axis d (3,) of a free spheroid, that many times as long as wide, points after the time t.

    In the flow u = G x (3, 3) d' = (W + B E) d but for what keeps its length 1, with the antisymmetric and
    the symmetric part of G and B = (r^2 - 1) / (r^2 + 1) (Jeffery 1922, Bretherton 1962): in shear it comes
    back after 2 pi (r + 1/r) / gamma.
    """
    B = (ratio**2 - 1.0) / (ratio**2 + 1.0)
    rate = 0.5 * (gradient - gradient.T) + 0.5 * B * (gradient + gradient.T)
    d = scipy.linalg.expm(t * rate) @ axis
    there: Array = d / np.linalg.norm(d)
    return there


def in_far_ball(resistance: float, radius: float, viscosity: float) -> float:
    """The resistance at the centre of a ball of some radius, but for (a / radius)^3 of it (Brenner 1962).

    R / (1 - 9/4 R / (6 pi mu radius)), by the first reflection of the body's force at the wall.
    """
    return resistance / (1.0 - 2.25 * resistance / (6.0 * np.pi * viscosity * radius))
