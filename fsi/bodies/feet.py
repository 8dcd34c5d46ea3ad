"""All gaps of bodies with shapes, of which a pair that is not convex may have several."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import Gaps, feet_on_walls, find_gaps, foot_between
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.feet import Foot
from fsi.meshes.geometry.wall_feet import all_wall_feet


def feet_between(q: Configuration, i: int, j: int, away: Array, reach: float) -> list[Foot]:
    """The gaps of body i to body j, or to its image that lies `away` from it, up to `reach`.

    The narrowest is the first, whatever its width.
    """
    if q.ellipsoids:
        return [foot_between(q, i, j, away)]
    other = q.placed[j]
    return q.placed[i].feet_to(other.moved(other.centre + away), reach)


def all_feet_on_walls(q: Configuration, i: int, container: Container, reach: float) -> list[list[Foot]]:
    """The gaps of body i to each wall up to `reach`, the narrowest first and whatever its width."""
    if q.ellipsoids:
        return [[foot] for foot in feet_on_walls(q, i, container)]
    return all_wall_feet(q.placed[i], container, reach)


@dataclass(frozen=True, slots=True, eq=False)
class Feet:
    """All gaps of a configuration of shapes, F in all, those of one pair of surfaces one after the other.

    Attributes:
        feet: where each is narrowest, those of each pair from the narrowest on.
        sides: a body, and a place in the bodies followed by the walls, (F, 2).
        away: how far the image of the second side that is meant lies from it, (F, d).
        of: the pair to which each belongs, pairs of bodies first, ascending, (F,).
    """

    feet: list[Foot]
    sides: NDArray[np.intp]
    away: Array
    of: NDArray[np.intp]

    @classmethod
    def at(
        cls,
        q: Configuration,
        container: Container,
        gaps: Gaps,
        reach: float,
        wanted: NDArray[np.intp] | None = None,
    ) -> Self:
        """Those of some pairs, and of all bodies and walls, up to `reach`, and the narrowest of each.

        wanted: of these, in their order, whose are asked for; all if None.
        """
        walls, pairs = len(container.walls), len(gaps.pairs)
        every = np.arange(pairs + walls * len(q))
        here = np.isin(every, every if wanted is None else wanted)
        each = zip(gaps.pairs.tolist(), gaps.away, here[:pairs].tolist(), strict=True)
        lists = [feet_between(q, i, j, e, reach) if some else [] for (i, j), e, some in each]
        sides = gaps.pairs.tolist()
        for i, some in enumerate(here[pairs:].reshape(len(q), walls)):
            of_body = all_feet_on_walls(q, i, container, reach) if some.any() else [[]] * walls
            lists += [feet if one else [] for feet, one in zip(of_body, some, strict=True)]
            sides += [[i, len(q) + k] for k in range(walls)]
        of = np.repeat(np.arange(len(lists)), [len(some) for some in lists])
        away = np.vstack([gaps.away, np.zeros((len(lists) - len(gaps.pairs), q.dimension))])
        feet = [foot for some in lists for foot in some]
        return cls(feet, np.array(sides, dtype=np.intp).reshape(-1, 2)[of], away[of], of)

    @property
    def gaps(self) -> Array:
        """Their widths, (F,)."""
        return np.array([foot.gap for foot in self.feet])

    @property
    def narrowest(self) -> NDArray[np.bool_]:
        """Which are the narrowest of their pair, (F,)."""
        return np.diff(self.of, prepend=-1) > 0

    def followed(self, later: Self, ways: Array) -> Array:
        """What became of these gaps at a later place of the same pairs, (F,).

        The narrowest of a pair is followed by the narrowest. Each other one is followed by the gap nearest to
        it along the body, of those which the motion can have made of it; where none is left it has gone, and
        counts as what it was, as those of a pair that was not looked at do.

        ways: how far each may have opened or closed, (F,).
        """
        after, now = self.gaps, later.gaps
        start = np.searchsorted(later.of, np.arange(self.of.max(initial=-1) + 2))
        for k, (foot, pair, first) in enumerate(zip(self.feet, self.of, self.narrowest, strict=True)):
            some = slice(start[pair], start[pair + 1])
            if some.start == some.stop:
                continue
            if first:
                after[k] = now[some][0]
                continue
            apart = np.array([abs((other.t - foot.t + 0.5) % 1.0 - 0.5) for other in later.feet[some]])
            apart[np.abs(now[some] - foot.gap) > ways[k]] = np.inf
            if np.isfinite(apart).any():
                after[k] = now[some][int(np.argmin(apart))]
        return after


def find_feet(q: Configuration, container: Container, reach: float) -> Feet:
    """All gaps of bodies with shapes up to `reach`, and the narrowest of each body and wall."""
    return Feet.at(q, container, find_gaps(q, container, reach), reach)
