"""The rates at which two surfaces slide along each other and roll, and what resists them.

With the tangents t of a pair, m = n x t (in the plane 1), V = (u_i - u_j).t and the distance d of the
centres, two bodies have the rates

    slide   s = V - l_i omega_i.m - l_j omega_j.m,     l_i = a_i d/(a_i + a_j)
    roll    a_r ((omega_i - omega_j).m + g s),         g -> (1/a_i - 1/a_j)/2 as the gap vanishes

and resist them by kappa of the law of shear, and of that of rotation over a_r^2. The loads of these rates are
opposite forces along t where the arms meet, and a couple: a rigid motion of both costs nothing. By Reynolds'
equation nothing couples the two rates of nearby surfaces. Of discs nothing does at any gap, with the g of
`two_discs`; spheres have that of narrow gaps, and a coupling C beside it.

Beside a wall, of curvature K along t (0 of a plane one), the laws are those of a body that moves along it and
of one that turns in place,

    shear      x = (1 - (a + D) K) V - c q y           q^2 = kappa_rotation / (a_r^2 kappa_shear)
    rotation   y = a (omega.m - K V)

with the resistances kappa_shear and (1 - c^2) kappa_rotation / a_r^2. The product c q couples the two as the
wall does: c = 0 of a disc (Jeffrey and Onishi 1981), and as the gap vanishes 1/4 of a sphere, of which the
logarithms are 16 pi/5 on the diagonal and -4 pi/5 off it (Goldman, Cox and Brenner 1967). Any resistances
>= 0, and any c from -1 to 1, leave the sum over all rows symmetric and positive semidefinite. A wall that
bends towards the body, K > 0, is like another body, of radius 1/K - a - D, that is held.

Sources: R. C. Ball and J. R. Melrose, Physica A 247 (1997) 444; S. Kim and S. J. Karrila, Microhydrodynamics
(1991), chapters 9 and 11.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.lubrication.expansions import Mode
from fsi.lubrication.two_discs import rolling_of_sliding

# c of a sphere beside a wall at small gaps; that of a disc is 0.
_COUPLING = {2: 0.0, 3: 0.25}


@dataclass(frozen=True, slots=True)
class Nearby:
    """Where the two sides of P pairs are.

    Attributes:
        n: unit normals from side j to body i, (P, d).
        gap: between them, (P,).
        radius: the reduced radius a_r, (P,).
        a: the radius of body i, (P,).
        b: that of side j; any of a wall, (P,).
        is_wall: whether side j is a wall, (P,).
        curvature: K of the gap to a wall along it, (P,).
    """

    n: Array
    gap: Array
    radius: Array
    a: Array
    b: Array
    is_wall: NDArray[np.bool_]
    curvature: Array

    @property
    def beside(self) -> NDArray[np.bool_]:
        """Which pairs have the laws beside a wall: those with walls that are plane or bend around bodies."""
        return self.is_wall & (self.curvature <= 0.0)

    @property
    def others(self) -> Array:
        """b, of a wall that bends towards the body too, (P,)."""
        held = self.is_wall & ~self.beside
        return np.where(held, 1.0 / np.where(held, self.curvature, 1.0) - self.a - self.gap, self.b)


@dataclass(frozen=True, slots=True)
class Factors:
    """Of V, omega_i.m and omega_j.m in a rate, and what resists it; all (P,)."""

    across: Array
    turn: Array
    turn_other: Array
    resistance: Array


def arms[Length: (float, Array)](a: Length, b: Length, gap: Length) -> tuple[Length, Length]:
    """`l_i` and `l_j` of bodies of radii a and b, which meet between their surfaces."""
    d = a + b + gap
    return a * d / (a + b), b * d / (a + b)


def slide_and_roll(
    pairs: Nearby, kappa: Mapping[Mode, Array], coupling: Array | None = None
) -> list[Factors]:
    """Of both rates, as far as there are laws; kappa of each, (P,), that of rotation over a_r^2.

    coupling: C of the power S s^2 - 2 C s y + R y^2 of both, (P,), else `narrow_coupling`.
    """
    wall, a, b = pairs.beside, pairs.a, pairs.others
    a_r, (arm, arm_other) = pairs.radius, arms(a, b, pairs.gap)
    g = rolling_of_sliding(pairs.gap, a, b) if pairs.n.shape[1] == 2 else 0.5 * (1.0 / a - 1.0 / b)
    K = np.where(wall, pairs.curvature, 0.0)
    C = narrow_coupling(pairs, kappa) if coupling is None else coupling
    across, turn = np.where(wall, -a * K, a_r * g), np.where(wall, a, a_r * (1.0 - g * arm))
    turn_other = np.where(wall, 0.0, -a_r * (1.0 + g * arm_other))
    found = []
    lean = np.zeros_like(a)
    if "shear" in kappa:
        S = kappa["shear"]
        lean = C / np.where(S != 0.0, S, np.inf)
        slid = np.where(wall, 1.0 - (a + pairs.gap) * K, 1.0) - lean * across
        turned = np.where(wall, 0.0, -arm) - lean * turn
        turned_other = np.where(wall, 0.0, -arm_other) - lean * turn_other
        found.append(Factors(slid, turned, turned_other, S))
    if "rotation" in kappa:
        found.append(Factors(across, turn, turn_other, kappa["rotation"] - lean * C))
    return found


def narrow_coupling(pairs: Nearby, kappa: Mapping[Mode, Array]) -> Array:
    """C = c q S of narrow gaps to walls, where there are both laws, and 0 elsewhere; (P,)."""
    c = _COUPLING[pairs.n.shape[1]]
    if len(kappa) < 2 or c == 0.0:
        return np.zeros_like(pairs.gap)
    size = np.sqrt(np.maximum(kappa["shear"] * kappa["rotation"], 0.0))
    C: Array = np.where(pairs.beside, c * size, 0.0)
    return C


def rate_rows(pairs: Nearby, t: Array, factors: Factors) -> tuple[Array, Array]:
    """What the velocities and rotations of body i and of side j count in a rate along t, (P, d + r) each.

    Those of walls, which are no unknowns, count zero.
    """
    m = np.ones((len(t), 1)) if t.shape[1] == 2 else np.cross(pairs.n, t)
    along = factors.across[:, None] * t
    of_i = np.hstack([along, factors.turn[:, None] * m])
    of_j = np.hstack([-along, factors.turn_other[:, None] * m])
    of_j[pairs.is_wall] = 0.0
    return of_i, of_j


def tangents(n: Array) -> list[Array]:
    """The d - 1 unit vectors across each n, (P, d)."""
    if n.shape[1] == 2:
        return [np.column_stack([-n[:, 1], n[:, 0]])]
    axis = np.eye(3)[np.abs(n).argmin(axis=1)]
    first = np.cross(n, axis)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return [first, np.cross(n, first)]
