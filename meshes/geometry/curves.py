"""The curves that bound a container in the plane, piece by piece: straight ones and arcs of circles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fsi.arrays import Array

if TYPE_CHECKING:
    from fsi.meshes.geometry.placed import Placed

SAMPLES = 65  # of a piece
DIGITS = 15  # what doubles keep of any decimal number


def rescaled(x: ArrayLike, factor: float) -> Array:
    """Lengths times a factor, to 15 digits.

    So lengths that a user gives in other units become the very same numbers: 2.1 of 1 and 2100 of 1000. A
    mesh generator breaks ties by the last bit, and with it chooses another mesh.
    """
    x = np.array(x, dtype=float)
    digits = [float(f"{number:.{DIGITS}g}") for number in (factor * x).ravel().tolist()]
    return np.array(digits).reshape(x.shape)


@dataclass(frozen=True, slots=True, eq=False)
class Sphere:
    """The circle or sphere |x - centre| = radius."""

    centre: Array
    radius: float

    @property
    def mean_curvature(self) -> float:
        """Of a sphere, and in the plane the curvature of the circle."""
        return 1.0 / self.radius

    @property
    def bends_all_ways(self) -> bool:
        """Whether it looks the same in all directions along it."""
        return True

    @property
    def opening(self) -> float:
        """The power m of the distance r to the centre in r^-m dA, the angle that a piece dA is seen under."""
        return 3.0

    def from_centre(self, x: Array) -> Array:
        """Vectors from what it is round about to points, any shape (..., d)."""
        return x - self.centre

    def project(self, x: Array) -> Array:
        """The points on it on the rays from the centre through x, any shape (..., d)."""
        from_centre = x - self.centre
        length = np.sqrt((from_centre**2).sum(axis=-1, keepdims=True))
        onto: Array = self.centre + self.radius * from_centre / length
        return onto

    # An ellipsoid answers these as the sphere that it is before it is stretched.

    @property
    def unit(self) -> Sphere:
        """Itself."""
        return self

    def unstretched(self, x: Array) -> Array:
        """Points as they are."""
        return x

    def stretched(self, y: Array) -> Array:
        """Vectors as they are."""
        return y


@dataclass(frozen=True, slots=True, eq=False)
class Cylinder(Sphere):
    """The round cylinder about the line through `centre` along z: a circle in every plane across it."""

    @property
    def mean_curvature(self) -> float:
        """Half that across the axis."""
        return 0.5 / self.radius

    @property
    def bends_all_ways(self) -> bool:
        """It is straight along its axis."""
        return False

    @property
    def opening(self) -> float:
        """Of an angle about the axis times a length along it."""
        return 2.0

    def from_centre(self, x: Array) -> Array:
        """From the nearest points of the axis."""
        across: Array = (x - self.centre) * [1.0, 1.0, 0.0]
        return across

    def project(self, x: Array) -> Array:
        """The points on it that are nearest to x, any shape (..., 3)."""
        across = self.from_centre(x)
        length = np.linalg.norm(across, axis=-1, keepdims=True)
        onto: Array = x + (self.radius / length - 1.0) * across
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
        solid: whose outline it follows, None for straight pieces and circles.
    """

    wall: int
    interval: tuple[float, float]
    at: Callable[[Array], Array]
    ends: Array
    longest_element: float
    fewest_elements: int
    centre: Array | None = None
    solid: Placed | None = None

    @property
    def samples(self) -> Array:
        """Some places on it, close enough to see where it goes."""
        return np.linspace(*self.interval, SAMPLES)


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


def stretched(curve: WallCurve, factor: float) -> WallCurve:
    """The piece with all lengths times a factor, places along it too."""
    start, end = (factor * s for s in curve.interval)
    centre = None if curve.centre is None else factor * curve.centre
    solid = None if curve.solid is None else curve.solid.scaled(factor)

    def at(s: Array) -> Array:
        return factor * curve.at(s / factor)

    longest, ends = factor * curve.longest_element, factor * curve.ends
    return WallCurve(
        curve.wall, (start, end), at, ends, longest, curve.fewest_elements, centre=centre, solid=solid
    )
