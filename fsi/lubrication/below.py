"""What laws add where a flow is solved with narrow gaps opened: resisted rates of pairs of bodies and walls.

Bodies that stand at places q are meshed at places x, with gaps D in place of d. Each near pair resists its
three relative motions, squeeze, shear and rotation, by the law R of the pair,

    + R(d)  times the rates at the places q,
    - R(D)  times the rates at the places x,

on top of what is resolved at x, which takes what the mesh resolves of the pair away again. For a lone pair
the sum is its whole resistance at d, whatever D is, but for what D changes of the flow around it. It vanishes
with the displacement, so that forces are continuous in the gap.

Lines of centres, arms and points of contact are those of either place: where many bodies lean on each other
places differ by several openings, and with them the rates at which a mean flow W x carries bodies past each
other. For the same reason a body that moves by U at q is meshed with the velocity U + W (x - q): what W does
to it is the same. Loads of either set of rates balance for themselves, and power is dissipation to rounding.

A law counts in full up to `FULL` times the reduced radius a_r and ends, falling linearly, at a_r: of bodies
farther apart others are nearer. Within a round wall it ends also where a body is nearer to the middle than to
the wall. Bodies nearer than `lubrication.below` are well within. A round wall that the fluid is around is
like another body, which is held.

Laws are the exact ones. Of spheres whose radii differ by more than a factor of five, and of discs within a
round wall, shear and rotation have the first term of their expansion, of which the difference lacks
(D - d)/a ln D. Turning about the line of centres, which no gap resists much, is that of x.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps, pair_gaps, wall_gaps
from fsi.bodies.opened import lubricating
from fsi.bodies.records import joined, those
from fsi.errors import SolveError
from fsi.lubrication import sliding_spheres
from fsi.lubrication.expansions import EXPONENTS, MODES, Mode, Shape
from fsi.lubrication.laws import LubricationLaw, ScaledLaw
from fsi.lubrication.named_laws import GapFilm, exact_law, leading_law
from fsi.lubrication.sliding import Factors, Nearby, rate_rows, slide_and_roll, tangents
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.reentrant import counted

FULL = 0.5
_STRAIGHT = 1e-9  # an axis is along a wall's normal to so much


@dataclass(frozen=True, slots=True)
class PairRates:
    """R rates of relative motion `G U - along.u`, u the velocity of the other side by itself.

    The loads on the bodies are resistance times rate times G.

    Attributes:
        G: over the modes of all bodies, (R, N M).
        along: what is measured of the other side's velocity, (R, d).
        place: the lattice vector of the image j, or the point on the wall, (R, d).
        apart: from the centre of the image j, or that point, to that of i, (R, d).
        wall: the number of the wall, -1 of two bodies, (R,).
        resistance: R(d) or - R(D), (R,).
        body: i and j, twice i beside a wall, (R, 2).
        meshed: whether the rate is that of the bodies where they are meshed, (R,).
    """

    G: Array
    along: Array
    place: Array
    apart: Array
    wall: NDArray[np.intp]
    resistance: Array
    body: NDArray[np.intp]
    meshed: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class NearPairs:
    """Pairs of bodies, and of bodies and walls, that the mesh has at other places.

    Attributes:
        body: i and j, twice i beside a wall, (P, 2).
        wall: the number of the wall, -1 of two bodies, (P,).
        away: the lattice vector of the image j, (P, d).
        weight: how much the law counts, from 0 to 1, (P,).
    """

    body: NDArray[np.intp]
    wall: NDArray[np.intp]
    away: Array
    weight: Array


@dataclass(frozen=True, slots=True)
class OpenedGaps:
    """Where bodies are, and where they are meshed.

    Attributes:
        q, meshed: the same bodies.
        container: what encloses them.
        below: gaps below this were opened.
        solid: the names of the walls beside which there are laws.
        spheres: whether laws are those of spheres.
        viscosity: mu.
    """

    q: Configuration
    meshed: Configuration
    container: Container
    below: float
    solid: tuple[str, ...]
    spheres: bool
    viscosity: float

    def rates(self) -> PairRates:
        """Those of all near pairs, at both places. Raises SolveError: no law is known of one."""
        parts = [
            part
            for near, sides in ((self._between(), self._sides_between), (self._beside(), self._sides_beside))
            for q, meshed in ((self.q, False), (self.meshed, True))
            for part in self._rows(near, *sides(near, q), meshed)
        ]
        return joined(parts)

    def _between(self) -> NearPairs:
        """Pairs of bodies of which one is displaced against the other."""
        a, x = self.q.radii, self.meshed.centres - self.q.centres
        found = find_gaps(self.q, self.container, 0.5 * float(a.max(initial=0.0)))
        i, j = found.pairs.T
        weight = _weight(found.pair_gaps, a[i] * a[j] / (a[i] + a[j]))
        near = NearPairs(found.pairs, np.full(len(i), -1), found.away, weight)
        return those(near, (weight > 0.0) & np.any(x[i] != x[j], axis=1))

    def _beside(self) -> NearPairs:
        """Bodies beside walls that are displaced. Raises SolveError: no law is known of one."""
        gaps = wall_gaps(self.q, self.container)
        there = lubricating(self.container, self.solid) & (gaps < np.inf)
        i, wall = np.nonzero(counted(self.container, self.q.centres, there))
        n, from_middle, a_r = self._of_walls(self.q, i, wall)
        gap = gaps[i, wall]
        curved = self.spheres & (from_middle < inf)
        if self.container.axisymmetric:
            curved |= np.abs(n[:, 0]) > _STRAIGHT
        if np.any(curved & (gap < self.below)):
            raise SolveError(
                f"lubrication.below = {self.below:g}: no law is known of a sphere beside a curved wall; "
                "give a smaller one, or drop it"
            )
        # Near the middle of a round wall the gap is as wide all around, and no law of a place on it holds.
        reach = np.maximum(np.minimum(a_r, from_middle), self.below / FULL)
        weight, moved = _weight(gap, reach), np.any(self.meshed.centres != self.q.centres, axis=1)
        near = NearPairs(np.stack([i, i], axis=1), wall, np.zeros((len(i), self.q.dimension)), weight)
        return those(near, (weight > 0.0) & moved[i] & ~curved)

    def _of_walls(
        self, q: Configuration, i: NDArray[np.intp], wall: NDArray[np.intp]
    ) -> tuple[Array, Array, Array]:
        """Normals (P, d) of bodies beside walls, distances from the walls' middles, and reduced radii, (P,).

        The middle of a plane is at infinity.
        """
        n = self.container.normals(q.centres)[i, wall] if len(i) else np.zeros((0, q.dimension))
        gap, a_r = (f[i, wall] for f in (wall_gaps(q, self.container), self.container.reduced_radii(q.radii)))
        R = np.array([inf if sphere is None else sphere.radius for sphere in self.container.spheres])
        return n, R[wall] - self._concavities(wall) * (q.radii[i] + gap), a_r

    def _concavities(self, wall: NDArray[np.intp]) -> Array:
        """1 of walls around bodies, -1 of those that bodies are around, 0 of planes, (P,)."""
        return np.array(self.container.concavities, dtype=float)[wall]

    def _sides_between(self, near: NearPairs, q: Configuration) -> tuple[Nearby, Array, Array]:
        """How the bodies stand at q; the lattice vectors, and from centre to centre, (P, d)."""
        i, j = near.body.T
        apart = q.centres[i] - q.centres[j] - near.away
        n = apart / np.linalg.norm(apart, axis=1)[:, None]
        a, b, gap = q.radii[i], q.radii[j], pair_gaps(q, near.body, near.away)
        sides = Nearby(n, gap, a * b / (a + b), a, b, np.zeros(len(i), dtype=bool), np.zeros(len(i)))
        return sides, near.away, apart

    def _sides_beside(self, near: NearPairs, q: Configuration) -> tuple[Nearby, Array, Array]:
        """How they stand beside walls; the nearest points of these, and from there to the centres."""
        i, a = near.body[:, 0], q.radii[near.body[:, 0]]
        n, from_middle, a_r = self._of_walls(q, i, near.wall)
        gap = wall_gaps(q, self.container)[i, near.wall]
        apart = (a + gap)[:, None] * n
        sides = Nearby(
            n, gap, a_r, a, a, np.ones(len(i), dtype=bool), -self._concavities(near.wall) / from_middle
        )
        return sides, q.centres[i] - apart, apart

    def _rows(
        self, near: NearPairs, sides: Nearby, place: Array, apart: Array, meshed: bool
    ) -> Iterator[PairRates]:
        """One rate of squeeze of each pair, then those along each tangent."""
        weight = -near.weight if meshed else near.weight
        kappa = self._resistances(sides)
        one, none = np.ones(len(weight)), np.zeros(len(weight))
        each = [(sides.n, Factors(one, none, none, kappa["squeeze"]))]
        if not self.container.axisymmetric:
            tangential: dict[Mode, Array] = {
                "shear": kappa["shear"],
                "rotation": kappa["rotation"] / sides.radius**2,
            }
            coupling = self._couplings(sides) if self.spheres else None
            each += [
                (t, factors)
                for t in tangents(sides.n)
                for factors in slide_and_roll(sides, tangential, coupling)
            ]
        for t, factors in each:
            of_i, of_j = rate_rows(sides, t, factors)
            # A moving image has the velocity of its body and that of the lattice.
            G = self._placed(near.body[:, 0], of_i) + self._placed(near.body[:, 1], of_j)
            along, resistance = of_i[:, : t.shape[1]], weight * factors.resistance
            where = np.full(len(weight), meshed)
            yield PairRates(G, along, place, apart, near.wall, resistance, near.body, where)

    def _placed(self, body: NDArray[np.intp], rows: Array) -> Array:
        """Rows (P, M) of a body each over the modes of all bodies, (P, N M)."""
        (P, M), N = rows.shape, len(self.q)
        placed = np.zeros((P, N, M))
        placed[np.arange(P), body] = rows
        return placed.reshape(P, N * M)

    def _resistances(self, sides: Nearby) -> dict[Mode, Array]:
        """R at the gaps of all pairs, of each mode, (P,)."""
        modes = MODES[:1] if self.container.axisymmetric else MODES
        R: dict[Mode, Array] = {mode: np.zeros(len(sides.gap)) for mode in modes}
        for k, (gap, a_r) in enumerate(zip(sides.gap, sides.radius, strict=True)):
            for mode in modes:
                R[mode][k] = self._law(mode, _ratio(sides, k)).kappa(gap, a_r)
        return R

    def _couplings(self, sides: Nearby) -> Array:
        """C of sliding and rolling spheres, of pairs whose other laws are exact too, (P,)."""
        C = np.zeros(len(sides.gap))
        for k, (gap, a_r) in enumerate(zip(sides.gap, sides.radius, strict=True)):
            ratio = _ratio(sides, k)
            if ratio == inf or ratio <= sliding_spheres.MOST_UNEQUAL:
                law = ScaledLaw(sliding_spheres.coupling(ratio), self.viscosity, 1, extrapolate=True)
                # Seen from the other sphere sliding has the other sign, and rolling has not.
                C[k] = law.kappa(gap, a_r) * (1.0 if sides.a[k] <= sides.b[k] else -1.0)
        return C

    def _law(self, mode: Mode, ratio: float) -> LubricationLaw:
        """The exact law where it is known."""
        shape: Shape = "spheres" if self.spheres else "discs"
        film = GapFilm(shape, self.viscosity, ratio, extrapolate=True, mode=mode)
        if mode == "squeeze" or ratio == inf or (not self.spheres and ratio > 0.0):
            return exact_law(film)
        if self.spheres and 0.0 < ratio <= sliding_spheres.MOST_UNEQUAL:
            profile = sliding_spheres.profiles(ratio)[mode]
            return ScaledLaw(profile, self.viscosity, EXPONENTS[shape, mode], extrapolate=True)
        return leading_law(film)


def _ratio(sides: Nearby, k: int) -> float:
    """|b/a| >= 1 of a pair; infinite beside a plane, with b = -R within a round wall and R on one."""
    a, a_r = float(sides.a[k]), float(sides.radius[k])
    if sides.is_wall[k] and sides.curvature[k] == 0.0:
        return inf
    ratio = a_r / (a - a_r) if sides.is_wall[k] else float(sides.b[k]) / a
    return max(ratio, 1.0 / ratio) if ratio > 0.0 else ratio


def _weight(gap: Array, a_r: Array) -> Array:
    """1 up to FULL a_r, 0 from a_r on."""
    weight: Array = np.clip((1.0 - gap / a_r) / (1.0 - FULL), 0.0, 1.0)
    return weight
