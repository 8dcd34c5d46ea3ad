"""Exact Stokes forces and torques on two spheres that move and turn in any way in unbounded fluid.

With e from the first centre to the second, F and T the EXTERNAL loads that velocities V and omega need,

    F_i = sum_j (X^A_ij e e + Y^A_ij (1 - e e)) V_j - Y^B_ji e x omega_j
    T_i = sum_j Y^B_ij e x V_j + (X^C_ij e e + Y^C_ij (1 - e e)) omega_j

X^A is that of `fsi.lubrication.spheres`. The others follow from multipoles around both centres: D. J. Jeffrey
and Y. Onishi, J. Fluid Mech. 139 (1984) 261; S. Kim and S. J. Karrila, "Microhydrodynamics" (1991), chapter
11. They expand them in powers of t_i = a_i / r, r the distance of the centres; here the same equations are
solved as they are, for the multipoles n of sphere i by those s of the other one, k. Across the line of
centres

    p_n = d_n1 V + sum_s C(n+s, n+1) t_i^(n-1) t_k^s (
          ( (2n+1)/(2(n+1)) (3(n+s) - (ns+1)(2ns-s-n+2))/(s(n+s)(2s-1)) + n(2n-1)/(2(n+1)) t_i^2 ) p_s
          + n(4n^2-1)/(2(n+1)(2s+1)) t_k^2 v_s + 2(4n^2-1)/(3(n+1)) t_k q_s )
    v_n = p_n + 2n/((n+1)(2n+3)) sum_s C(n+s, n+1) t_i^(n+1) t_k^s p_s
    q_n = d_n1 a_i omega + sum_s C(n+s, n+1) t_i^n t_k^s ( s/(n+1) t_k q_s + 3/(2 n s (n+1)) p_s )
    F = 6 pi mu a_i p_1,   T = 8 pi mu a_i^2 q_1

where each sphere counts x, y, z in a frame of its own with z towards the other one, y common, V along x and
omega along y; and for rotations about the line of centres, with omega along its own z,

    q_n = d_n1 a_i omega + sum_s C(n+s, n) s/(n+1) t_i^n t_k^(s+1) q_s

Relative error of the matrix: 1e-13, measured against 1.4 times the multipoles. Gaps that take more than MOST
of them, narrow ones and those beside a sphere many times as large, raise ValueError, as do such as are not
positive.
"""

from typing import NamedTuple

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array
from fsi.lubrication.exact import bipolar_angle
from fsi.lubrication.spheres import line_forces

MOST = 1000  # multipoles, whose matrix takes 130 MB; equal spheres reach it at q / a = 4e-4
_DECAY = 20.0  # multipoles up to n al = 20, al the smaller bispherical angle


class PairFunctions(NamedTuple):
    """The scalar functions of two spheres, (2, 2) each: of loads on the first index by motions of the second.

    Not divided by anything: XA and YA are forces over velocities, YB torques over velocities, XC and YC
    torques over angular velocities.
    """

    XA: Array
    YA: Array
    YB: Array
    XC: Array
    YC: Array


def pair_functions(gap: float, radii: tuple[float, float], viscosity: float) -> PairFunctions:
    """X^A, Y^A, Y^B, X^C and Y^C of spheres of these radii at a gap from surface to surface."""
    n = orders(gap, radii)
    along = [line_forces(gap, radii, viscosity, velocities) for velocities in ((1.0, 0.0), (0.0, 1.0))]
    force, torque = (np.pi * viscosity * c * np.array(radii) ** k for c, k in ((6.0, 1), (8.0, 2)))
    # Turned by half a turn about y, the frame of the second sphere is that of the first.
    half_turn = np.array([1.0, -1.0, 1.0, 1.0])
    across = half_turn[:, None] * _across(n, radii, gap) * half_turn
    about = _about(n, radii, gap) * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return PairFunctions(
        np.array(along, dtype=np.float64).T,
        force[:, None] * across[:2, :2],
        torque[:, None] * across[2:, :2],
        torque[:, None] * about,
        torque[:, None] * across[2:, 2:],
    )


def pair_matrix(centres: Array, radii: tuple[float, float], viscosity: float) -> Array:
    """The resistance matrix (12, 12) of (F_1, T_1, F_2, T_2) by (V_1, omega_1, V_2, omega_2).

    centres: (2, 3). Its inverse is the mobility.
    """
    apart = np.asarray(centres[1] - centres[0], dtype=np.float64)
    r = float(np.linalg.norm(apart))
    of = pair_functions(r - sum(radii), radii, viscosity)
    e = apart / r
    along, turn = np.outer(e, e), np.cross(np.eye(3), e)  # turn @ V = e x V
    across = np.eye(3) - along
    R = np.zeros((2, 6, 2, 6))
    for i in range(2):
        for j in range(2):
            R[i, :3, j, :3] = of.XA[i, j] * along + of.YA[i, j] * across
            R[i, 3:, j, :3] = of.YB[i, j] * turn
            R[j, :3, i, 3:] = of.YB[i, j] * turn.T
            R[i, 3:, j, 3:] = of.XC[i, j] * along + of.YC[i, j] * across
    return R.reshape(12, 12)


def orders(gap: float, radii: tuple[float, float]) -> Array:
    """The multipoles n = 1, 2, ... that are taken."""
    small, large = min(radii), max(radii)
    height = gap * (2.0 * small + gap) / (2.0 * large * (small + large + gap))
    most = _DECAY / float(bipolar_angle(height)) + 8.0 if gap > 0.0 else np.inf
    if not most <= MOST:
        raise ValueError(
            f"gap = {gap}, radii = {radii}: takes {most:.4g} multipoles, more than {MOST}; widen it"
        )
    return np.arange(1.0, np.ceil(most))


def couplings(n: Array, own: float, other: float, m: int) -> Array:
    """C(n + s, n + m) t_i^n t_k^s, which stays below 1 as t_i + t_k < 1, rows n and columns s."""
    rows, s = n[:, None], n[None, :]
    logs = scipy.special.gammaln(rows + s + 1.0) - scipy.special.gammaln(rows + m + 1.0)
    logs -= scipy.special.gammaln(s - m + 1.0)
    found: Array = np.exp(logs + rows * np.log(own) + s * np.log(other))
    return found


def _across(n: Array, radii: tuple[float, float], gap: float) -> Array:
    """(p_1 of both spheres, then q_1) by (V of both, then omega), (4, 4), in own frames."""
    size, r = len(n), sum(radii) + gap
    identity, zero = np.eye(size), np.zeros((size, size))
    one, two = (blocks_across(n, radii[i] / r, radii[1 - i] / r) for i in range(2))
    matrix = np.block(
        [
            [identity - one["pv"] @ two["vp"], -one["pp"] - one["pv"], zero, -one["pq"]],
            [-two["pp"] - two["pv"], identity - two["pv"] @ one["vp"], -two["pq"], zero],
            [zero, -one["qp"], identity, -one["qq"]],
            [-two["qp"], zero, -two["qq"], identity],
        ]
    )
    firsts = size * np.arange(4)
    sides = np.zeros((4 * size, 4))
    sides[firsts, np.arange(4)] = 1.0, 1.0, *radii
    found: Array = scipy.linalg.solve(matrix, sides)[firsts]
    return found


def blocks_across(n: Array, t: float, u: float) -> dict[str, Array]:
    """Of p of a sphere, t = a_i / r, from p, v, q of the other, u = a_k / r; of v from p; of q from p, q."""
    rows, s = n[:, None], n[None, :]
    C = couplings(n, t, u, 1)
    below = (3 * (rows + s) - (rows * s + 1) * (2 * rows * s - s - rows + 2)) / (s * (rows + s) * (2 * s - 1))
    above = rows * (2 * rows - 1) / (2 * (rows + 1)) * t * t
    return {
        "pp": C / t * ((2 * rows + 1) / (2 * (rows + 1)) * below + above),
        "pv": C / t * rows * (4 * rows**2 - 1) / (2 * (rows + 1) * (2 * s + 1)) * u * u,
        "pq": C / t * 2 * (4 * rows**2 - 1) / (3 * (rows + 1)) * u,
        "vp": C * t * 2 * rows / ((rows + 1) * (2 * rows + 3)),
        "qp": C * 3 / (2 * rows * s * (rows + 1)),
        "qq": C * s / (rows + 1) * u,
    }


def _about(n: Array, radii: tuple[float, float], gap: float) -> Array:
    """q_1 of both spheres by omega of both about the line of centres, (2, 2), in own frames."""
    size, r = len(n), sum(radii) + gap
    (t, u), weight = (radius / r for radius in radii), n[None, :] / (n[:, None] + 1.0)
    identity = np.eye(size)
    of_first, of_second = couplings(n, t, u, 0) * weight * u, couplings(n, u, t, 0) * weight * t
    matrix = np.block([[identity, -of_first], [-of_second, identity]])
    sides = np.zeros((2 * size, 2))
    sides[[0, size], [0, 1]] = radii
    found: Array = scipy.linalg.solve(matrix, sides)[[0, size]]
    return found


def in_far_ball(mobility: Array, radius: float, viscosity: float) -> Array:
    """The mobility (12, 12) where a ball around the origin, which is near both spheres, holds the fluid.

    A Stokeslet F at its centre has the flow -9 F / (24 pi mu R) there in return (Brenner 1962, J. Fluid Mech.
    12:35). What is left out is (b / R)^3 of the largest entries, b how far the spheres reach from the origin.
    """
    moved = mobility.copy().reshape(2, 6, 2, 6)
    moved[:, :3, :, :3] -= 9.0 / (24.0 * np.pi * viscosity * radius) * np.eye(3)[:, None]
    return moved.reshape(12, 12)
