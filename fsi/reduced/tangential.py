"""How near surfaces slide and roll: rows by which pairs resist all relative motion but that of their gaps.

With the tangents t of a pair, m = n x t (in the plane 1), V = (u_i - u_j).t and the distance d of the
centres, two bodies have the rates

    slide   s = V - l_i omega_i.m - l_j omega_j.m,     l_i = a_i d/(a_i + a_j)
    roll    a_r ((omega_i - omega_j).m + g s),         g = (1/a_i - 1/a_j)/2

and resist them by kappa of the law of shear, and of that of rotation over a_r^2. The loads of these rates are
opposite forces along t where the arms meet, and a couple: a rigid motion of both costs nothing. By Reynolds'
equation nothing couples the two rates of nearby surfaces; of equal discs nothing does at any gap.

Beside a wall, of curvature K along t (0 of a plane one), the laws are those of a body that moves along it and
of one that turns in place,

    shear      x = (1 - (a + D) K) V - c q y           q^2 = kappa_rotation / (a_r^2 kappa_shear)
    rotation   y = a (omega.m - K V)

with the resistances kappa_shear and (1 - c^2) kappa_rotation / a_r^2. The product c q couples the two as the
wall does: c = 0 of a disc (Jeffrey and Onishi 1981), 1/4 of a sphere, of which the logarithms are 16 pi/5 on
the diagonal and -4 pi/5 off it (Goldman, Cox and Brenner 1967). Any resistances >= 0 leave the sum over all
rows symmetric and positive semidefinite.

Sources: R. C. Ball and J. R. Melrose, Physica A 247 (1997) 444; S. Kim and S. J. Karrila, Microhydrodynamics
(1991), chapters 9 and 11.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.bodies.configuration import MODES, Array
from fsi.lubrication.expansions import Mode
from fsi.reduced.enclosure import Enclosure
from fsi.reduced.gap_laws import GapLaws
from fsi.reduced.pairs import Pairs

# c of a sphere beside a wall; that of a disc is 0.
_COUPLING = {2: 0.0, 3: 0.25}


@dataclass(frozen=True, slots=True)
class TangentialRows:
    """R rates that pairs resist, of velocities and rotations.

    Attributes:
        G: (R, N M).
        own: the part that walls and images move by themselves, (R,).
        resistance: force over rate, >= 0, (R,).
        between: whether of two bodies, or beside a wall, (R,).
        pair: of which pair, (R,).
        tangent: t, (R, d).
        across: the factor of V, (R,).
        turn: that of omega_i.m, (R,).
    """

    G: sp.csr_matrix
    own: Array
    resistance: Array
    between: NDArray[np.bool_]
    pair: NDArray[np.intp]
    tangent: Array
    across: Array
    turn: Array


def tangential_rows(
    pairs: Pairs, radii: Array, laws: Mapping[Mode, GapLaws], enclosure: Enclosure
) -> TangentialRows:
    """The rows of all pairs by the laws there are. Raises SolveError where a law does not hold."""
    x, films = np.log(pairs.gap), pairs.films
    kappa = {mode: law.kappa(x, films) for mode, law in laws.items()}
    if "rotation" in kappa:
        kappa["rotation"] = kappa["rotation"] / pairs.radius**2
    factors = _factors(pairs, radii, kappa)
    parts = [
        _rows(pairs, len(radii), enclosure, tangent, factor)
        for tangent in _tangents(pairs.n)
        for factor in factors
    ]
    return _stacked(parts)


@dataclass(frozen=True, slots=True)
class _Factors:
    """Of V, omega_i.m and omega_j.m in a rate, and what resists it; all (P,)."""

    across: Array
    turn: Array
    turn_other: Array
    resistance: Array


def _factors(pairs: Pairs, radii: Array, kappa: Mapping[Mode, Array]) -> list[_Factors]:
    """Of both rates, as far as there are laws; kappa of each, that of rotation over a_r^2."""
    wall = pairs.is_wall
    a, b = radii[pairs.i], radii[np.where(wall, pairs.i, pairs.j)]
    d, a_r = a + b + pairs.gap, pairs.radius
    arm, arm_other = a * d / (a + b), b * d / (a + b)
    g = 0.5 * (1.0 / a - 1.0 / b)
    K = np.where(wall, pairs.curvature, 0.0)
    c = _COUPLING[pairs.n.shape[1]] if len(kappa) == 2 else 0.0
    q = _ratio(kappa) if c else np.zeros_like(a)
    along, found = 1.0 - (a + pairs.gap) * K + c * q * a * K, []
    if "shear" in kappa:
        across, turn = np.where(wall, along, 1.0), np.where(wall, -c * q * a, -arm)
        found.append(_Factors(across, turn, np.where(wall, 0.0, -arm_other), kappa["shear"]))
    if "rotation" in kappa:
        across, turn = np.where(wall, -a * K, a_r * g), np.where(wall, a, a_r * (1.0 - g * arm))
        turn_other = np.where(wall, 0.0, -a_r * (1.0 + g * arm_other))
        part = np.where(wall, 1.0 - c**2, 1.0)
        found.append(_Factors(across, turn, turn_other, part * kappa["rotation"]))
    return found


def _ratio(kappa: Mapping[Mode, Array]) -> Array:
    """q, 0 where nothing resists shear."""
    shear = kappa["shear"]
    q: Array = np.sqrt(kappa["rotation"] / np.where(shear > 0.0, shear, np.inf))
    return q


def _tangents(n: Array) -> list[Array]:
    """The d - 1 unit vectors across each n, (P, d)."""
    if n.shape[1] == 2:
        return [np.column_stack([-n[:, 1], n[:, 0]])]
    axis = np.eye(3)[np.abs(n).argmin(axis=1)]
    first = np.cross(n, axis)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return [first, np.cross(n, first)]


def _rows(
    pairs: Pairs, bodies: int, enclosure: Enclosure, tangent: Array, factors: _Factors
) -> TangentialRows:
    """One row of each pair, along one tangent."""
    P, d = pairs.n.shape
    M = len(MODES[d])
    m = np.ones((P, 1)) if d == 2 else np.cross(pairs.n, tangent)
    along = factors.across[:, None] * tangent
    side = np.hstack([along, factors.turn[:, None] * m])
    other = np.hstack([-along, factors.turn_other[:, None] * m])
    other[pairs.is_wall] = 0.0
    j = np.where(pairs.is_wall, pairs.i, pairs.j)
    columns = M * np.stack([pairs.i, j], axis=1)[:, :, None] + np.arange(M)
    row = np.repeat(np.arange(P), 2 * M)
    # A body and its own image share columns, whose entries are summed.
    entries = np.stack([side, other], axis=1).ravel()
    G = sp.coo_matrix((entries, (row, columns.ravel())), shape=(P, M * bodies)).tocsr()
    velocity = pairs.shift @ enclosure.gradient.T
    walls = np.flatnonzero(pairs.is_wall)
    velocity[walls] = enclosure.wall_velocity[pairs.j[walls] - bodies]
    own = np.einsum("pk,pk->p", along, velocity)
    return TangentialRows(
        G, own, factors.resistance, ~pairs.is_wall, np.arange(P), tangent, factors.across, factors.turn
    )


def _stacked(parts: list[TangentialRows]) -> TangentialRows:
    """All rows of some."""
    G = sp.vstack([part.G for part in parts], "csr")
    names = ("own", "resistance", "between", "pair", "tangent", "across", "turn")
    return TangentialRows(G, *(np.concatenate([getattr(part, name) for part in parts]) for name in names))
