"""Spheres in cubic arrays by Stokeslets: forces and viscosities that owe nothing to meshes.

The flow is a sum of Stokeslets of the lattice, of zero mean (Hasimoto 1959, J. Fluid Mech. 5:317; summed as
by Lindbo and Tornberg 2010, J. Comput. Phys. 229:8994), on a sphere inside of each body; their strengths meet
the velocity on its surface in the least squares. All has the symmetries of cube and flow: what a place and a
force are turned into has the same strength, or the opposite one.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations, product

import numpy as np
import scipy

from fsi.arrays import Array

LATTICES: dict[str, Array] = {
    "simple cubic": np.eye(3),
    "body-centred": np.array([[-0.5, 0.5, 0.5], [0.5, -0.5, 0.5], [0.5, 0.5, -0.5]]),
    "face-centred": np.array([[0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]]),
}
INSIDE = 0.65  # radius of the Stokeslets' sphere, over that of the body
EXTENSION, SHEAR = np.diag([1.0, -1.0, 0.0]), np.array([[0.0, 0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0]])
CUBE = [np.diag(s)[list(p)] for p in permutations(range(3)) for s in product((1.0, -1.0), repeat=3)]


def drag(kind: str, c: float, points: int = 1500) -> float:
    """K of the force 6 pi mu a K U on a sphere at rest in the mean velocity U, at the volume fraction c."""
    along = np.array([1.0, 0.0, 0.0])
    a, _, forces = _strengths(
        kind, c, points, lambda g: g @ along @ along, lambda x: np.tile(along, (len(x), 1))
    )
    return float(forces.sum(axis=0)[0] / (6.0 * np.pi * a))


def viscosity(kind: str, c: float, E: Array, points: int = 1500) -> float:
    """Apparent viscosity over mu in the mean flow E x, E one of EXTENSION and SHEAR."""
    volume, size = abs(np.linalg.det(LATTICES[kind])), np.tensordot(E, E)

    def sign(g: Array) -> float:
        return float(np.tensordot(g @ E @ g.T, E) / size)

    _, x, forces = _strengths(kind, c, points, sign, lambda x: -x @ E.T)
    stresslet = -np.tensordot(forces.T @ x, E)
    return float(1.0 + stresslet / (2.0 * volume * size))


def _strengths(
    kind: str, c: float, points: int, sign: Callable[[Array], float], velocity: Callable[[Array], Array]
) -> tuple[float, Array, Array]:
    """Radius of the spheres, places (n, 3) of all Stokeslets in one of them, and their forces (n, 3)."""
    lattice = LATTICES[kind]
    a = float((0.75 * c * abs(np.linalg.det(lattice)) / np.pi) ** (1.0 / 3.0))
    group = [(g, sign(g)) for g in CUBE if abs(abs(sign(g)) - 1.0) < 1e-12]
    on, inside = a * _alone(2 * points, group), INSIDE * a * _alone(points, group)
    matrix = np.zeros((len(on), 3, len(inside), 3))
    for g, chi in group:
        apart = (on[:, None] - inside @ g.T).reshape(-1, 3)
        one = stokeslets(apart, lattice).reshape(len(on), len(inside), 3, 3)
        matrix += chi * np.einsum("nmij,jk->nimk", one, g)
    flat = matrix.reshape(3 * len(on), -1)
    forces = np.linalg.lstsq(flat, velocity(on).ravel(), rcond=1e-14)[0].reshape(-1, 3)
    every = [(inside @ g.T, chi * forces @ g.T) for g, chi in group]
    return a, np.concatenate([x for x, _ in every]), np.concatenate([f for _, f in every])


def _alone(points: int, group: list[tuple[Array, float]]) -> Array:
    """Of points all over the unit sphere those that come first among what they are turned into."""
    k = np.arange(points) + 0.5
    z, angle = 1.0 - 2.0 * k / points, np.pi * (1.0 + 5.0**0.5) * k
    r = np.sqrt(1.0 - z * z)
    x = np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    order = np.array([1.0, 1e-2, 1e-4])
    first = np.all([x @ order >= x @ g.T @ order - 1e-15 for g, _ in group], axis=0)
    return np.asarray(x[first])


def stokeslets(x: Array, lattice: Array) -> Array:
    """Velocity (n, 3, 3) at x (n, 3) for unit forces on the points of a lattice, mu = 1, of zero mean."""
    volume, unit, n = abs(np.linalg.det(lattice)), np.eye(3), 5
    xi = np.sqrt(np.pi) / volume ** (1.0 / 3.0)
    x = x - np.rint(x @ np.linalg.inv(lattice)) @ lattice
    G = np.zeros((len(x), 3, 3))
    for t in product(range(-n, n + 1), repeat=3):
        shift = np.array(t) @ lattice
        if np.linalg.norm(shift) * xi > 7.5:
            continue
        y = x + shift
        r2 = (y * y).sum(axis=1)[:, None, None]
        near = np.exp(-xi * xi * r2) / np.sqrt(np.pi)
        radial = 2.0 * xi * near / r2 + scipy.special.erfc(xi * np.sqrt(r2)) / r2**1.5
        G += radial * (r2 * unit + y[:, :, None] * y[:, None, :]) - 4.0 * xi * near * unit
    waves = 2.0 * np.pi * np.linalg.inv(lattice).T
    for t in product(range(-n, n + 1), repeat=3):
        k = np.array(t) @ waves
        s = k @ k / (4.0 * xi * xi)
        if 0.0 < s < 40.0:
            factor = 8.0 * np.pi * (1.0 + s) * np.exp(-s) / ((k @ k) ** 2 * volume)
            G += np.cos(x @ k)[:, None, None] * factor * (k @ k * unit - np.outer(k, k))
    return G / (8.0 * np.pi)
