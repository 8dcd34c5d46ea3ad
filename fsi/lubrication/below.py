"""What laws add where a flow is solved with narrow gaps opened: resisted rates of pairs of bodies and walls.

Where bodies that stand at gaps d are meshed at gaps D, each near pair resists its three relative motions,
squeeze, shear and rotation, by

    R(d) - R(D)     of the law of the pair,

on top of what is resolved at D: for a lone pair that is its whole resistance at d, whatever D is, but for
what D changes of the flow around it. It vanishes with the displacement, so that forces are continuous in the
gap. Laws end at the gap REACH times that below which gaps are opened: there they are less their value at it.

The lines of centres, arms and points of contact are those of the bodies as they are meshed, so that loads
balance, rigid motions cost nothing and power is dissipation to rounding in the geometry of the flow. The
relative error of that is of the order of D/a, as is what D changes of the flow.

Laws are the exact ones; of two spheres, and within a round wall, shear and rotation have the first term of
their expansion, of which the difference lacks (D - d)/a ln D.
"""

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import MODES as MODES_OF_BODY
from fsi.bodies.configuration import Array, Configuration
from fsi.bodies.gaps import find_gaps, pair_gaps, wall_gaps
from fsi.bodies.opened import lubricating
from fsi.errors import SolveError
from fsi.lubrication.expansions import MODES, Mode, Shape
from fsi.lubrication.laws import CutLaw, LubricationLaw
from fsi.lubrication.named_laws import GapFilm, exact_law, leading_law
from fsi.lubrication.sliding import Nearby, slide_and_roll, tangents
from fsi.meshes.geometry.container import Container

REACH = 10.0
_STRAIGHT = 1e-9  # an axis is along a wall's normal to so much


@dataclass(frozen=True, slots=True)
class PairRates:
    """R rates of relative motion `G U - along.u`, u the velocity of the other side by itself.

    The loads on the bodies are resistance times rate times G.

    Attributes:
        G: over the modes of all bodies, (R, N M).
        along: what is measured of the other side's velocity, (R, d).
        place: the lattice vector of the image j, or the point on the wall, (R, d).
        wall: the number of the wall, -1 of two bodies, (R,).
        resistance: R(d) - R(D), (R,).
        body: i and j, twice i beside a wall, (R, 2).
        gaps: d and D, (R, 2).
    """

    G: Array
    along: Array
    place: Array
    wall: NDArray[np.intp]
    resistance: Array
    body: NDArray[np.intp]
    gaps: Array


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
        """Those of all near pairs. Raises SolveError: no law is known of one."""
        between, beside = self._between(), self._beside()
        parts = [part for pairs in (between, beside) for part in self._rows(*pairs)]
        names = ("G", "along", "place", "wall", "resistance", "body", "gaps")
        return PairRates(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))

    @property
    def _cut(self) -> float:
        return REACH * self.below

    def _between(self) -> tuple[Nearby, Array, NDArray[np.intp], NDArray[np.intp], Array]:
        """Pairs of bodies, their real gaps, bodies, walls (none) and images."""
        found = find_gaps(self.q, self.container, self._cut)
        i, j = found.pairs.T
        x, radii = self.meshed.centres, self.q.radii
        across = x[i] - x[j] - found.away
        n = across / np.linalg.norm(across, axis=1)[:, None]
        a, b = radii[i], radii[j]
        meshed, none = pair_gaps(self.meshed, found.pairs, found.away), np.zeros(len(i))
        sides = Nearby(n, meshed, a * b / (a + b), a, b, np.zeros(len(i), dtype=bool), none)
        return sides, found.pair_gaps, found.pairs, np.full(len(i), -1), found.away

    def _beside(self) -> tuple[Nearby, Array, NDArray[np.intp], NDArray[np.intp], Array]:
        """Bodies and walls likewise, and the nearest points of the walls."""
        container, radii, x = self.container, self.q.radii, self.meshed.centres
        gaps = wall_gaps(self.q, container)
        near = lubricating(container, self.solid)
        i, wall = np.nonzero((gaps <= self._cut) & near)
        n = container.normals(x)[i, wall] if len(i) else np.zeros((0, x.shape[1]))
        meshed, a = wall_gaps(self.meshed, container)[i, wall], radii[i]
        a_r, K = a.copy(), np.zeros(len(i))
        for k, each in enumerate(wall):
            if (sphere := container.spheres[each]) is not None:
                a_r[k] = a[k] * sphere.radius / (sphere.radius - a[k])
                K[k] = -1.0 / (sphere.radius - a[k] - meshed[k])
        curved = self.spheres & (K != 0.0)
        if container.axisymmetric:
            curved |= np.abs(n[:, 0]) > _STRAIGHT
        if np.any(curved & (gaps[i, wall] < self.below)):
            raise SolveError(
                f"lubrication.below = {self.below:g}: no law is known of a sphere beside a curved wall; "
                "give a smaller one, or drop it"
            )
        foot = x[i] - (a + meshed)[:, None] * n
        kept = ~curved
        sides = Nearby(n, meshed, a_r, a, a, np.ones(len(i), dtype=bool), K)
        sides = Nearby(*(getattr(sides, name)[kept] for name in Nearby.__slots__))
        return sides, gaps[i, wall][kept], np.stack([i, i], axis=1)[kept], wall[kept], foot[kept]

    def _rows(
        self, sides: Nearby, gap: Array, bodies: NDArray[np.intp], wall: NDArray[np.intp], place: Array
    ) -> list[PairRates]:
        """One rate of squeeze of each pair, then those along each tangent."""
        kappa = self._more(sides, gap)
        gaps, one, none = np.stack([gap, sides.gap], axis=1), np.ones(len(gap)), np.zeros(len(gap))
        each = [(sides.n, one, none, none, kappa["squeeze"])]
        if not self.container.axisymmetric:
            tangential: dict[Mode, Array] = {
                "shear": kappa["shear"],
                "rotation": kappa["rotation"] / sides.radius**2,
            }
            each += [
                (t, f.across, f.turn, f.turn_other, f.resistance)
                for t in tangents(sides.n)
                for f in slide_and_roll(sides, tangential)
            ]
        rates = []
        for t, across, turn, turn_other, resistance in each:
            along, turns = across[:, None] * t, self._axes(sides.n, t)
            G = self._placed(bodies[:, 0], along, turn[:, None] * turns)
            G += (wall < 0)[:, None] * self._placed(bodies[:, 1], -along, turn_other[:, None] * turns)
            # A moving image has the velocity of its body and that of the lattice.
            rates.append(PairRates(G, along, place, wall, resistance, bodies, gaps))
        return rates

    @staticmethod
    def _axes(n: Array, t: Array) -> Array:
        """m = n x t, (P, r): in the plane 1."""
        return np.ones((len(n), 1)) if n.shape[1] == 2 else np.cross(n, t)

    def _placed(self, body: NDArray[np.intp], along: Array, turns: Array) -> Array:
        """Rows over the modes of all bodies, (P, N M)."""
        N, d = self.q.centres.shape
        rows = np.zeros((len(body), N, len(MODES_OF_BODY[d])))
        rows[np.arange(len(body)), body] = np.hstack([along, turns])
        return rows.reshape(len(body), N * rows.shape[2])

    def _more(self, sides: Nearby, gap: Array) -> dict[Mode, Array]:
        """R(d) - R(D) of all modes, (P,) each."""
        modes = MODES[:1] if self.container.axisymmetric else MODES
        more: dict[Mode, Array] = {mode: np.zeros(len(gap)) for mode in modes}
        for k, (d, D, a_r) in enumerate(zip(gap, sides.gap, sides.radius, strict=True)):
            ratio = float(sides.b[k] / sides.a[k])
            if sides.is_wall[k]:
                ratio = inf if sides.curvature[k] == 0.0 else float(-a_r / (a_r - sides.a[k]))
            for mode in modes:
                law = CutLaw(self._law(mode, max(ratio, 1.0 / ratio) if ratio > 0.0 else ratio), self._cut)
                more[mode][k] = law.kappa(d, a_r) - law.kappa(D, a_r)
        return more

    def _law(self, mode: Mode, ratio: float) -> LubricationLaw:
        """The exact law where it is known."""
        shape: Shape = "spheres" if self.spheres else "discs"
        film = GapFilm(shape, self.viscosity, ratio, extrapolate=True, mode=mode)
        is_known = mode == "squeeze" or ratio == inf or (not self.spheres and ratio > 0.0)
        return exact_law(film) if is_known else leading_law(film)
