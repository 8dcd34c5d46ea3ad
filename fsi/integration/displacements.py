"""How large displacements are beside what bodies feel of them: their radius, their gaps, and radians.

Bodies in a cell repeat on a lattice, and what displaces it by G x displaces the image of a body at e by G e
more than the body. So of bodies that counts what they do besides, d - G x, which all images have alike.
"""

from dataclasses import dataclass, replace

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.feet import Feet
from fsi.bodies.gaps import Gaps, find_gaps, pair_gaps, wall_gaps
from fsi.meshes.geometry.container import Container

SMALL = 1e-3  # of the smallest gap or radius: how far bodies go where their gaps are differenced


@dataclass(frozen=True, slots=True)
class Displacements:
    """Of bodies and of the lattice on which they repeat; or the rates of both.

    Attributes:
        q: where the bodies are.
        container: where they are.
        of_modes: of the bodies, (N, M), or with that of a lattice (see `fsi.integration.state.velocities`).
        gradient: G of the lattice, rows of (dd_i / dx_j), (d, d); zero of what has no images.
    """

    q: Configuration
    container: Container
    of_modes: Array
    gradient: Array

    def size(self) -> float:
        """The largest part of what bodies feel.

        Each displacement counts over the radius, each angle in radians, a strain of the lattice as it is, and
        each gap's change over the gap, which is what lubrication feels; bodies that are close and move
        together are not held to their gap.
        """
        d, besides = self.q.dimension, self._besides()
        of_bodies = np.linalg.norm(besides[:, :d], axis=1) / self.q.radii
        strain = np.array([abs(self.q.strain_of(self.of_modes))])
        sizes = [of_bodies, np.abs(besides[:, d:]), self._gap_changes(besides), strain]
        return float(max(part.max(initial=0.0) for part in sizes))

    def _besides(self) -> Array:
        """Of the bodies, (N, M), more than the lattice has where they are."""
        besides = self.of_modes[: len(self.q)].copy()
        besides[:, : self.q.dimension] -= self.q.centres @ self.gradient.T
        return besides

    def _gap_changes(self, besides: Array) -> Array:
        """|gap'| / gap of all near pairs and walls, for gaps that change at the rate of the displacements."""
        q, largest = self.q, float(self.q.radii.max(initial=0.0))
        # Near gaps are a diameter wide at most, centres four radii apart: none changes by more than twice it.
        furthest = float(q.ways(besides).max(initial=0.0)) + 2.0 * largest * np.linalg.norm(self.gradient, 2)
        if furthest == 0.0:
            return np.zeros(1)
        gaps = find_gaps(q, self.container)
        small = SMALL * min(gaps.smallest(), float(q.radii.min())) / furthest
        moved = q.moved(small * self.of_modes)
        after = replace(gaps, away=gaps.away + small * gaps.away @ self.gradient.T)
        if q.shaped:
            return self._shape_gap_changes(moved, (gaps, after), 2.0 * small * furthest) / small
        of_pairs = (pair_gaps(moved, gaps.pairs, after.away) - gaps.pair_gaps) / gaps.pair_gaps
        of_walls = (wall_gaps(moved, self.container) - gaps.wall_gaps) / gaps.wall_gaps
        return np.abs(np.concatenate([of_pairs, of_walls.ravel()])) / small

    def _shape_gap_changes(self, moved: Configuration, gaps: tuple[Gaps, Gaps], way: float) -> Array:
        """By how much of itself each of all gaps of bodies with shapes changes on a small way.

        gaps: those before, and the same with the images where they are after; way: by which one may change.
        """
        reach, (before, after) = 2.0 * float(self.q.radii.max()), gaps
        feet = Feet.at(self.q, self.container, before, reach)
        ways = np.full(len(feet.feet), way)
        later = feet.followed(Feet.at(moved, self.container, after, reach), ways)
        return np.abs(later - feet.gaps) / feet.gaps
