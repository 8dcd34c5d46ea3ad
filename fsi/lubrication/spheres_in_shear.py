"""Two equal free spheres in a linear flow that nothing bounds: how they move past each other, exactly.

In the flow `u = omega x x + E.x` the second centre moves relative to the first, at r = r e from it, by

    r' = omega x r + E.r - (A e e + B (1 - e e)).E.r

G. K. Batchelor and J. T. Green, J. Fluid Mech. 56 (1972) 375. By the reciprocal theorem A and B follow from
forces F, torques T and stresslets S of spheres that move in fluid at rest: of each motion m of the first
sphere, which the second one mirrors, the free velocities v and omega in the strain obey

    v F_m + omega T_m = E:(x F_m + S_m),    x the place of the first sphere.

These are the multipoles of `fsi.lubrication.two_spheres`, F = -6 pi mu a p_1, T = -8 pi mu a^2 q_1 and
S = -3 pi mu a^2 p_2, which is n z and z n across the line of centres (n, z = e) and z z - 1/3 along it. Along
that line (Jeffrey and Onishi 1984), with t = a / r,

    p_n = d_n1 V + sum_s C(n+s, n) t^(n+s-1) (
          ( n(2n+1)(2ns-n-s+2)/(2(n+1)(2s-1)(n+s)) - n(2n-1)/(2(n+1)) t^2 ) p_s
          - n(4n^2-1)/(2(n+1)(2s+1)) t^2 v_s )
    v_n = p_n - 2n/((n+1)(2n+3)) sum_s C(n+s, n) t^(n+s+1) p_s

so that A = t p_2 / p_1 and far apart A = 5 t^3, B = 16 t^5 / 3; at contact A = 1. Gaps below 4e-4 a, which
take too many multipoles, raise ValueError.
"""

from collections.abc import Sequence

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array
from fsi.lubrication.two_spheres import blocks_across, couplings, orders

TOLERANCE = 1e-7  # of trajectories


def mobility_in_strain(gap: float, radius: float) -> tuple[float, float]:
    """A and B of spheres of this radius at this gap from surface to surface."""
    n, r = orders(gap, (radius, radius)), 2.0 * radius + gap
    p = multipoles_along(n, radius / r)
    A = radius / r * p[1] / p[0]
    p, q = multipoles_across(n, radius, radius / r)
    F, T, S = -6.0 * radius * p[0], -8.0 * radius**2 * q[0], -3.0 * radius**2 * p[1]
    v, _ = np.linalg.solve(np.column_stack([F, T]), -0.5 * r * F + 2.0 * S)
    return float(A), float(1.0 + 2.0 * v / r)


def multipoles_along(n: Array, t: float) -> Array:
    """p_n of equal spheres that approach each other at the speed 1 each, t = a / r."""
    rows, s = n[:, None], n[None, :]
    C = couplings(n, t, t, 0) / t
    below = (
        rows * (2 * rows + 1) * (2 * rows * s - rows - s + 2) / (2 * (rows + 1) * (2 * s - 1) * (rows + s))
    )
    above = rows * (2 * rows - 1) / (2 * (rows + 1)) * t**2
    of_v = C * rows * (4 * rows**2 - 1) / (2 * (rows + 1) * (2 * s + 1)) * t**2
    v = np.eye(len(n)) - C * t**2 * 2 * rows / ((rows + 1) * (2 * rows + 3))
    found: Array = scipy.linalg.solve(
        np.eye(len(n)) - C * (below - above) + of_v @ v, (n == 1.0).astype(float)
    )
    return found


def multipoles_across(n: Array, radius: float, t: float) -> Array:
    """p_n and q_n of equal spheres that do alike in their own frames: move at speed 1, turn; (2, n, 2)."""
    of, one, size = blocks_across(n, t, t), np.eye(len(n)), len(n)
    matrix = np.block(
        [[one - of["pp"] - of["pv"] @ (one + of["vp"]), -of["pq"]], [-of["qp"], one - of["qq"]]]
    )
    sides = np.zeros((2, size, 2))
    sides[0, 0, 0], sides[1, 0, 1] = 1.0, radius
    found: Array = scipy.linalg.solve(matrix, sides.reshape(-1, 2)).reshape(sides.shape)
    return found


def relative_velocity(r: Array, radius: float, gradient: Array) -> Array:
    """r', (3,), in the flow u = gradient x."""
    apart = float(np.linalg.norm(r))
    A, B = mobility_in_strain(apart - 2.0 * radius, radius)
    stretched = 0.5 * (gradient + gradient.T) @ r
    along = r * (r @ stretched) / apart**2
    velocity: Array = gradient @ r - A * along - B * (stretched - along)
    return velocity


def relative_path(start: Sequence[float], radius: float, gradient: Array, times: Array) -> Array:
    """r at times from 0 on, (times, 3), in the flow u = gradient x."""
    solved = scipy.integrate.solve_ivp(
        lambda _, r: relative_velocity(r, radius, gradient), (0.0, float(times[-1])), start, "DOP853", times,
        rtol=TOLERANCE, atol=TOLERANCE * radius,
    )  # fmt: skip
    path: Array = solved.y.T
    return path
