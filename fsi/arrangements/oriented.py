"""Ellipses or rods where they stand in a cell, and the gaps between them."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.arrangements.cell import SimulationCell
from fsi.arrangements.convex import ConvexShape, Couples, apart
from fsi.arrays import Array

Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class OrientedBodies:
    """N bodies of one shape in a cell.

    Attributes:
        cell: it is longer along its periods than two of them: a body meets one image of another at most.
        shape: of all, with the area pi.
        radii: by which its lengths are multiplied, (N,).
        x: their centres, (N, 2).
        theta: the angles of their long axes to x, (N,).
    """

    cell: SimulationCell
    shape: ConvexShape
    radii: Array
    x: Array
    theta: Array

    @property
    def longest(self) -> float:
        """The largest length of a body."""
        return 2.0 * self.shape.half_length * float(self.radii.max())

    def couples(self, reach: float) -> tuple[Indices, Indices, Couples]:
        """The pairs i, j (P,) whose centres are no farther apart than `reach`, and how they lie."""
        i, j = self.cell.near_pairs(self.x, reach).T
        both = np.column_stack([i, j])
        return i, j, Couples(self.cell.separation(self.x[i], self.x[j]), self.radii[both], self.theta[both])

    def wall_room(self) -> tuple[Array, Array]:
        """How far bodies are from the walls, and by how much more if they turn, (N, walls) each."""
        axes = np.tile(self.cell.walled, 2)
        h, slope = self.shape.support(0.5 * pi * axes - self.theta[:, None])
        return self.cell.wall_distances(self.x) - self.radii[:, None] * h, self.radii[:, None] * slope

    def smallest_gap(self) -> float:
        """Between bodies, their images included; infinite for one body between walls."""
        smallest, reach = self._to_own_images(), 2.0 * self.longest
        while True:
            *_, couples = self.couples(reach)
            smallest = min(smallest, float(apart(self.shape, couples)[0].min(initial=np.inf)))
            if smallest <= reach - self.longest or reach > 2.0 * sum(self.cell.sides):
                return smallest
            reach *= 2.0

    def _to_own_images(self) -> float:
        periods = np.diag(self.cell.sides)[np.array(self.cell.periodic)]
        twice = [np.column_stack([values, values]) for values in (self.radii, self.theta)]
        own = (Couples(np.tile(e, (len(self.radii), 1)), *twice) for e in periods)
        return min((float(apart(self.shape, couples)[0].min()) for couples in own), default=np.inf)

    def rims(self, points: int) -> Array:
        """Points around the bodies, seen from their centres, (N, points, 2)."""
        c, s = np.cos(self.theta), np.sin(self.theta)
        rows = np.stack([np.column_stack([c, s]), np.column_stack([-s, c])], axis=1)
        return np.asarray(self.radii[:, None, None] * (self.shape.rim(points) @ rows))

    def described(self) -> tuple[dict[str, Any], ...]:
        """Each as an entry of [[bodies]], called ellipse0001 or rod0001 and on."""
        each = zip(self.radii.tolist(), self.x.tolist(), self.theta.tolist(), strict=True)
        return tuple(
            {
                "name": f"{self.shape.kind}{number:04d}",
                "shape": self.shape.described(a),
                "position": tuple(centre),
                "angle": angle,
            }
            for number, (a, centre, angle) in enumerate(each, 1)
        )
