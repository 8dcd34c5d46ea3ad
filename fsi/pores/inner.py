"""The flow inside fluid discs: biharmonic polynomials, whose dissipation is exact.

Beyond the four rigid numbers, with z = (dx + i dy) / a, they are Re and Im of z^2, z^3, |z|^2 z, and of
z^m, |z|^2 z^(m-2) for m = 4 ... M.
"""

import numpy as np

from fsi.arrays import Array


def inner_powers(order: int) -> list[tuple[int, int]]:
    """(m, k) of the functions |z|^(2 k) z^m in their order."""
    return [(2, 0), (3, 0), (1, 1)] + [pair for m in range(4, order + 1) for pair in ((m, 0), (m - 2, 1))]


def inner_form(order: int) -> Array:
    """Their dissipation in a disc of radius 1 of fluid of viscosity 1.

    With 2 e:e = 16 |d^2 psi / dz^2|^2 it is 4 pi m^2 (m - 1) of z^m, 4 pi m^2 (m + 1) of |z|^2 z^m, and
    4 pi m (m^2 - 1) between the two of the same m and part.
    """
    powers = inner_powers(order)
    one = np.zeros((len(powers), len(powers)))
    for i, (m, k) in enumerate(powers):
        for j, (n, other) in enumerate(powers):
            if m == n:
                one[i, j] = m * m * (m + 2.0 * k - 1.0) if k == other else m * (m * m - 1.0)
    return np.asarray(np.kron(4.0 * np.pi * one, np.eye(2)))


def inner_flow(r: Array, a: Array, numbers: Array, order: int) -> Array:
    """psi and its derivatives, (6, n), at r (n, 2) from centres of discs a (n,) with numbers (n, .)."""
    z = (r[:, 0] + 1j * r[:, 1]) / a
    U, V, omega, c = numbers[:, :4].T
    zero = np.zeros_like(a)
    square = np.stack([np.abs(z) ** 2, 2 * z.real / a, 2 * z.imag / a, 2 / a**2, zero, 2 / a**2])
    psi = -0.5 * omega * a**2 * (square - np.eye(6)[:, :1])
    psi += np.stack([c + U * r[:, 1] - V * r[:, 0], -V, U, zero, zero, zero])
    for (m, k), re, im in zip(inner_powers(order), numbers.T[4::2], numbers.T[5::2], strict=True):
        f = _harmonic(z, a, m, re - 1j * im)
        psi += _product(f, square) if k else f
    return np.asarray(psi)


def _product(f: Array, g: Array) -> Array:
    """By Leibniz' rule, (6, n)."""
    first = [f[0] * g[0], f[1] * g[0] + f[0] * g[1], f[2] * g[0] + f[0] * g[2]]
    cross = (f[1] * g[1] * 2.0, f[1] * g[2] + f[2] * g[1], f[2] * g[2] * 2.0)
    return np.stack(first + [f[k] * g[0] + cross[k - 3] + f[0] * g[k] for k in (3, 4, 5)])


def _harmonic(z: Array, a: Array, m: int, factor: Array) -> Array:
    """Re(factor z^m) with its derivatives, (6, n)."""
    zero, first = factor * z**m, factor * m * z ** (m - 1) / a
    second = factor * m * (m - 1) * z ** max(m - 2, 0) / a**2
    parts = (zero, first, 1j * first, second, 1j * second, -second)
    return np.stack([part.real for part in parts])
