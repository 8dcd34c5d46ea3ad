"""The cell: the plane, periodic along two lattice vectors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fsi.meshes.geometry.containers import Array, WithoutWalls
from fsi.meshes.geometry.curves import WallCurve
from fsi.meshes.geometry.lattice import reduced

Vector = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Cell(WithoutWalls):
    """The plane with a lattice that moves with the mean flow `u = E x`.

    The lattice at time t is that of `exp(E t)` times the vectors, given by its reduced basis: a sheared
    lattice returns to itself at whole strains, and no cell is ever more oblique than it must be.

    Attributes:
        vectors: two lattice vectors at time 0.
        gradient: E, rows of (dV_i / dx_j), without trace.
        time: t.
    """

    vectors: tuple[Vector, Vector]
    gradient: tuple[Vector, Vector]
    time: float = 0.0

    def outline(self) -> tuple[WallCurve, ...]:
        """There are no walls."""
        return ()

    def size(self) -> float:
        """Length of the longer diagonal."""
        a, b = self.periods
        return float(max(np.hypot(*(a + b)), np.hypot(*(a - b))))

    def carried(self, e: Array, duration: float) -> Array:
        """Vectors e (n, 2) carried along by the mean flow: exp(E t) e."""
        E = self.mean_gradient
        rate = np.sqrt(max(-np.linalg.det(E), 0.0))  # E has no trace: E^2 = -det(E) I
        by_E = np.sinh(rate * duration) / rate if rate > 0.0 else duration
        moved: Array = e @ (np.cosh(rate * duration) * np.eye(2) + by_E * E).T
        return moved

    @property
    def periods(self) -> Array:
        """The reduced basis at this time, (2, 2)."""
        return reduced(self.carried(np.array(self.vectors), self.time))

    @property
    def image_reach(self) -> float:
        """The longer diagonal of a cell of this area is at least as long, however it is sheared."""
        return float(np.sqrt(2.0 * self.volume))

    def at(self, t: float) -> Cell:
        """The cell at time t."""
        return Cell(self.vectors, self.gradient, t)

    @property
    def mean_gradient(self) -> Array:
        """E, (2, 2)."""
        return np.array(self.gradient)

    @property
    def volume(self) -> float:
        """Of fluid and bodies together, an area; the flow preserves it."""
        return float(abs(np.linalg.det(np.array(self.vectors))))

    @property
    def middle(self) -> Array:
        """Half of both vectors of the reduced basis."""
        middle: Array = 0.5 * self.periods.sum(axis=0)
        return middle
