"""The curves that bound a container in the plane, piece by piece: straight ones and arcs of circles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Sphere:
    """The circle or sphere |x - centre| = radius."""

    centre: Array
    radius: float

    def project(self, x: Array) -> Array:
        """The points on it on the rays from the centre through x, any shape (..., d)."""
        from_centre = x - self.centre
        length = np.sqrt((from_centre**2).sum(axis=-1, keepdims=True))
        onto: Array = self.centre + self.radius * from_centre / length
        return onto


class WallCurve(Protocol):
    """A piece of a wall, with the fluid on its left; its places are lengths s along it."""

    @property
    def wall(self) -> int:
        """Which of the container's walls it belongs to."""

    @property
    def ends(self) -> Array:
        """Its first and its last point, (2, 2), the same numbers as where other pieces begin and end."""

    @property
    def interval(self) -> tuple[float, float]:
        """s at both ends."""

    @property
    def centre(self) -> Array | None:
        """Of its circle, None for a straight piece."""

    @property
    def longest_element(self) -> float:
        """What no element on it exceeds."""

    @property
    def fewest_elements(self) -> int:
        """How many it has at least."""

    def at(self, s: Array) -> Array:
        """The points (n, 2) at places s (n,)."""


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """The straight piece between two points, (2, 2)."""

    wall: int
    ends: Array

    @property
    def interval(self) -> tuple[float, float]:
        """From 0 to its length."""
        return 0.0, float(np.hypot(*(self.ends[1] - self.ends[0])))

    @property
    def centre(self) -> None:
        """None."""
        return

    @property
    def longest_element(self) -> float:
        """A quarter of it."""
        return 0.25 * self.interval[1]

    @property
    def fewest_elements(self) -> int:
        """4."""
        return 4

    def at(self, s: Array) -> Array:
        """The points at distances s from the first."""
        along: Array = (self.ends[1] - self.ends[0]) / self.interval[1]
        x: Array = self.ends[0] + s[:, None] * along
        return x


@dataclass(frozen=True, slots=True)
class Arc:
    """The arc around the origin between two angles in radians, counterclockwise: the fluid lies inside."""

    wall: int
    radius: float
    start: float
    end: float

    @property
    def ends(self) -> Array:
        """Exactly on the axes at multiples of pi / 2, where other curves begin."""
        directions = [[np.cos(a), np.sin(a)] for a in (self.start, self.end)]
        ends: Array = self.radius * np.round(directions, 15)
        return ends

    @property
    def interval(self) -> tuple[float, float]:
        """The angles times the radius."""
        return self.start * self.radius, self.end * self.radius

    @property
    def centre(self) -> Array:
        """The origin."""
        return np.zeros(2)

    @property
    def longest_element(self) -> float:
        """Half the radius."""
        return 0.5 * self.radius

    @property
    def fewest_elements(self) -> int:
        """8."""
        return 8

    def at(self, s: Array) -> Array:
        """The points at angles s / radius."""
        return self.radius * np.column_stack([np.cos(s / self.radius), np.sin(s / self.radius)])
