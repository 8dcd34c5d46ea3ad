"""The curves that bound a container in the plane, piece by piece: straight ones and arcs of circles."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

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


@dataclass(frozen=True, slots=True, eq=False)
class WallCurve:
    """A piece of a wall, with the fluid on its left; its places are lengths s along it.

    Attributes:
        wall: which of the container's walls it belongs to.
        interval: s at both ends.
        at: the points (n, 2) at places s (n,).
        ends: the first and the last point, (2, 2), the same numbers as where other pieces begin and end.
        longest_element: what no element on it exceeds.
        fewest_elements: how many it has at least.
        centre: of its circle, (2,), None for a straight piece.
    """

    wall: int
    interval: tuple[float, float]
    at: Callable[[Array], Array]
    ends: Array
    longest_element: float
    fewest_elements: int
    centre: Array | None = None


def segment(wall: int, start: ArrayLike, end: ArrayLike) -> WallCurve:
    """The straight piece between two points."""
    ends = np.array([start, end], dtype=float)
    length = float(np.hypot(*(ends[1] - ends[0])))
    along = (ends[1] - ends[0]) / length
    return WallCurve(wall, (0.0, length), lambda s: ends[0] + s[:, None] * along, ends, 0.25 * length, 4)


def arc(wall: int, radius: float, start: float, end: float) -> WallCurve:
    """The arc around the origin between two angles, counterclockwise: the fluid lies inside."""

    def at(s: Array) -> Array:
        return radius * np.column_stack([np.cos(s / radius), np.sin(s / radius)])

    # Exactly on the axes at multiples of pi / 2, where other curves begin.
    ends = radius * np.round([[np.cos(angle), np.sin(angle)] for angle in (start, end)], 15)
    return WallCurve(wall, (start * radius, end * radius), at, ends, 0.5 * radius, 8, np.zeros(2))
