"""How near surfaces slide and roll: rows by which pairs resist all relative motion but that of their gaps.

The rates, and what resists them, are those of `fsi.lubrication.sliding`; the sum over all rows is symmetric
and positive semidefinite. Beside walls with exact laws of both, spheres have their exact coupling too, less
that at the cutoff. It is below that of narrow gaps, c = 1/4, at all gaps and cutoffs, and tends to it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import MODES
from fsi.bodies.records import joined
from fsi.case.case import Case
from fsi.lubrication.expansions import Mode
from fsi.lubrication.laws import CutLaw, LubricationLaw, ScaledLaw
from fsi.lubrication.profiles import TabulatedProfile
from fsi.lubrication.sliding import (
    Factors,
    Nearby,
    narrow_coupling,
    rate_rows,
    slide_and_roll,
    tangents,
)
from fsi.lubrication.sphere_beside_plane import coupling_resistance
from fsi.reduced.enclosure import Enclosure
from fsi.reduced.gap_laws import GapLaws
from fsi.reduced.pairs import Pairs, own_velocity
from fsi.reduced.possible_films import beside_walls

# Of s: from where the laws of spheres are tabulated to where C is 1e-7 of its largest, and falls like s^-4.
_NEAREST, _FARTHEST, _POINTS = 1e-8, 30.0, 140


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


def make_coupling(case: Case) -> LubricationLaw | None:
    """C of sliding and rolling spheres beside walls; None where not both of their laws are exact."""
    asked, cut = case.reduced, case.reduced.cutoff
    names = {asked.wall_shear_law or asked.shear_law, asked.wall_rotation_law or asked.rotation_law}
    if not case.spheres or names != {"exact"} or cut is None or not beside_walls(case):
        return None
    return CutLaw(ScaledLaw(_coupling_beside_plane(), case.fluid.viscosity, 1, extrapolate=True), cut)


@cache
def _coupling_beside_plane() -> TabulatedProfile:
    s = np.geomspace(_NEAREST, _FARTHEST, _POINTS)
    # By parts, as all gaps that are summed together take as many terms as the smallest.
    C = np.concatenate([coupling_resistance(part, 1.0, 1.0) for part in np.array_split(s, 10)])
    return TabulatedProfile(s, C, smooth=True)


def tangential_rows(
    pairs: Pairs,
    radii: Array,
    laws: Mapping[Mode, GapLaws],
    coupling: LubricationLaw | None,
    enclosure: Enclosure,
) -> TangentialRows:
    """The rows of all pairs by the laws there are. Raises SolveError where a law does not hold."""
    x, films = np.log(pairs.gap), pairs.films
    kappa = {mode: law.kappa(x, films) for mode, law in laws.items()}
    if "rotation" in kappa:
        kappa["rotation"] = kappa["rotation"] / pairs.radius**2
    other = radii[np.where(pairs.is_wall, pairs.i, pairs.j)]
    sides = Nearby(pairs.n, pairs.gap, pairs.radius, radii[pairs.i], other, pairs.is_wall, pairs.curvature)
    C = narrow_coupling(sides, kappa)
    if coupling is not None:
        wall = np.flatnonzero(sides.is_wall)
        C[wall] = np.minimum(C[wall], coupling.kappa(pairs.gap[wall], pairs.radius[wall]))
    factors = slide_and_roll(sides, kappa, C)
    parts = [
        _rows(pairs, sides, len(radii), enclosure, tangent, factor)
        for tangent in tangents(pairs.n)
        for factor in factors
    ]
    return joined(parts)


def _rows(
    pairs: Pairs, sides: Nearby, bodies: int, enclosure: Enclosure, tangent: Array, factors: Factors
) -> TangentialRows:
    """One row of each pair, along one tangent."""
    P, d = pairs.n.shape
    M = len(MODES[d])
    of_i, of_j = rate_rows(sides, tangent, factors)
    j = np.where(pairs.is_wall, pairs.i, pairs.j)
    columns = M * np.stack([pairs.i, j], axis=1)[:, :, None] + np.arange(M)
    row = np.repeat(np.arange(P), 2 * M)
    # A body and its own image share columns, whose entries are summed.
    entries = np.stack([of_i, of_j], axis=1).ravel()
    G = sp.coo_matrix((entries, (row, columns.ravel())), shape=(P, M * bodies)).tocsr()
    own = np.einsum("pk,pk->p", of_i[:, :d], own_velocity(pairs, bodies, enclosure))
    return TangentialRows(
        G, own, factors.resistance, ~pairs.is_wall, np.arange(P), tangent, factors.across, factors.turn
    )
