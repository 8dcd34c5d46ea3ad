"""A small sphere off the axis of a long closed tube, under a force along it, by one reflection at the wall.

A sphere of radius a at the distance b from the axis of a tube of radius R moves with (H. Faxen; Happel and
Brenner, Low Reynolds number hydrodynamics, 1965, section 7-3)

    U = F / (6 pi mu a) + (1 + a^2/6 lap) w,      Omega = curl w / 2,

where w is what the wall adds to the flow (1 + a^2/6 lap) G F of the sphere alone, G that of a point force.
The stresslet of the sphere, which is left out, changes U by a^4 / R^4 of it, on the axis by less.

With harmonic phi, chi, psi all Stokes flows inside, of no net flux but for waves of no length, are

    w = grad phi + curl(chi e_z) + r d/dr grad psi + e_z d psi/dz,      p = -2 mu d^2 psi / dz^2,

here sums over n and integrals over k of I_n(k r) (cos, sin, cos)(n theta) sin(k z). The point force's own
waves along the axis are, with the distance s from its line (8 pi mu = F = 1),

    u_s = (2/pi) int k s K_0(k s) sin(k z) dk,      u_z = (2/pi) int (2 K_0(k s) - k s K_1(k s)) cos(k z) dk,

and its Laplacian is the gradient of `(4/pi) int k K_0(k s) sin(k z) dk`.
"""

import numpy as np
from scipy.special import iv, ivp, kv

# Gauss points over k R in (0, SHORTEST), dense towards 0, where waves have a logarithm; angles; modes n.
WAVES, SHORTEST, ANGLES, MODES = 60, 30.0, 128, 30


def motion(radius: float, tube: float, off_axis: float) -> tuple[float, float]:
    """(6 pi mu a U / F, 8 pi mu a^2 Omega / F) under F e_z, about e_y, of the sphere at x = off_axis >= 0."""
    a, b = radius / tube, off_axis / tube
    nodes, weights = np.polynomial.legendre.leggauss(WAVES)
    velocity = turning = 0.0
    theta = 2.0 * np.pi * np.arange(ANGLES) / ANGLES
    s = np.sqrt(1.0 + b**2 - 2.0 * b * np.cos(theta))
    t = 0.5 * (nodes + 1.0)
    for k, dk in zip(SHORTEST * t**2, SHORTEST * t * weights, strict=True):
        outwards = k * s * kv(0, k * s) - a**2 / 3.0 * k**2 * kv(1, k * s)
        along = 2.0 * kv(0, k * s) - k * s * kv(1, k * s) + a**2 / 3.0 * k**2 * kv(0, k * s)
        u = np.stack([outwards * (1.0 - b * np.cos(theta)) / s, outwards * b * np.sin(theta) / s, along])
        for n in range(MODES):
            least = 1.0 if n == 0 else 2.0
            waves = (np.cos(n * theta), np.sin(n * theta), np.cos(n * theta))
            target = -least * np.array([np.mean(part * wave) for part, wave in zip(u, waves, strict=True)])
            scale = iv(n, k)
            M = _modes(n, k, 1.0) / scale
            if n == 0:
                M[1, 1] = 1.0  # there is no chi
            A, B, C = np.linalg.solve(M, target) / scale
            w = _modes(n, k, b) @ (A, B, C)
            velocity += dk * (w[2] + a**2 / 6.0 * 2.0 * k**3 * C * iv(n, k * b))
            # curl w = dw_r/dz - dw_z/dr at theta = 0.
            by_r = A * k**2 * ivp(n, k * b) + C * k**2 * (2.0 * ivp(n, k * b) + k * b * ivp(n, k * b, 2))
            turning += dk * 0.5 * (k * w[0] - by_r)
    return 1.0 + 1.5 / np.pi * a * float(velocity), 2.0 / np.pi * a**2 * float(turning)


def _modes(n: int, k: float, r: float) -> np.ndarray:
    """(w_r, w_theta, w_z) as rows, without their waves, of phi, chi and psi."""
    value, first, second = iv(n, k * r), ivp(n, k * r), ivp(n, k * r, 2)
    # n I_n(k r) / r, which on the axis is k I_n' for n = 1 and else nothing.
    around = n * value / r if r > 0.0 else k * first * (n == 1)
    return np.array(
        [
            [k * first, around, k**2 * r * second],
            [-around, -k * first, -n * k * first + around],
            [k * value, 0.0, k**2 * r * first + k * value],
        ]
    )
