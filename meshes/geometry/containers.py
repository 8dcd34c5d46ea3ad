"""The containers that hold fluid and bodies, as plain NumPy geometry.

A container knows its walls by name, how far a point lies from each of them, and nothing of
meshes or physics. Lengths are in the user's unit; points are arrays of shape (n, 2), in space (n, 3) with z
upwards.

An axisymmetric container is a meridian half-plane: points are (r, z) with r >= 0, and the side r = 0 is the
axis, which is no wall.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Container(Protocol):
    """What encloses the fluid; a value, equal to others with the same numbers."""

    def __hash__(self) -> int:
        """Of its numbers."""

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space: the number of coordinates of a point."""

    @property
    def axisymmetric(self) -> bool:
        """True where points are (r, z)."""

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of the walls, in the order of every array over walls."""

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """For each wall the axis of its normal at its corners: that velocity component is its own there."""

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to each wall, shape (n, walls); positive inside."""

    def size(self) -> float:
        """A length that no distance inside exceeds."""

    def axis(self) -> tuple[float, float]:
        """Lowest and highest z of an axisymmetric container on its axis."""

    @property
    def periods(self) -> Array:
        """Vectors that carry the domain onto itself, as rows, shape (k, d); without any (0, 1)."""

    @property
    def volume(self) -> float:
        """Of fluid and bodies together: an area in the plane and in the meridional plane."""

    @property
    def mean_gradient(self) -> Array:
        """E of the mean flow u = E x, rows of (dV_i / dx_j), shape (d, d): zero but in a cell."""

    def at(self, t: float) -> Container:
        """The container at time t; only a sheared cell changes."""

    def carried(self, e: Array, duration: float) -> Array:
        """What vectors e (n, d) between images become after some time."""

    @property
    def middle(self) -> Array:
        """The middle of the box around it, or of what a cell's vectors span from the origin, (d,)."""


def boundary_names(container: Container) -> tuple[str, ...]:
    """Names of the walls, and last `axis` or `cut` where there is one, in the order of their tags.

    The tags follow the bodies'. The cut is where a periodic domain was opened for meshing.
    """
    if container.axisymmetric:
        return (*container.walls, "axis")
    return (*container.walls, "cut") if len(container.periods) else container.walls


def boundary_distances(container: Container, x: Array) -> Array:
    """Distance of each point (n, dimension) to each of `boundary_names`."""
    to_walls = container.distances(x)
    return np.column_stack([to_walls, x[:, 0]]) if container.axisymmetric else to_walls


def lengths(x: Array) -> Array:
    """Euclidean length of each vector, shape (n, dimension) -> (n,)."""
    length: Array = np.hypot.reduce(x, axis=1)
    return length


class Steady:
    """A container that is not periodic and does not change."""

    __slots__ = ()

    @property
    def periods(self) -> Array:
        """None, shape (0, 1)."""
        return np.empty((0, 1))

    def at(self, t: float) -> Self:  # noqa: ARG002
        """The container itself."""
        return self

    def carried(self, e: Array, duration: float) -> Array:  # noqa: ARG002
        """Vectors between images after some time: the same."""
        return e


@dataclass(frozen=True, slots=True)
class Box(Steady):
    """Rectangle [lower, upper] with walls left, right, bottom, top; in space also front and back.

    In space left and right are the ends in x, front and back in y, bottom and top in z.
    A channel is a long box whose left and right ends are open. Axisymmetric, it is a cylinder: lower[0] is 0
    and there is no wall left.
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    axisymmetric: bool = False

    @property
    def dimension(self) -> int:
        """Of its corners."""
        return len(self.lower)

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of the walls."""
        if self.dimension == 3:
            return ("left", "right", "front", "back", "bottom", "top")
        return ("right", "bottom", "top") if self.axisymmetric else ("left", "right", "bottom", "top")

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """The axis across each wall: x for left and right, and so on."""
        if self.dimension == 3:
            return (0, 0, 1, 1, 2, 2)
        return (0, 1, 1) if self.axisymmetric else (0, 0, 1, 1)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to the walls, shape (n, walls)."""
        low = x - np.asarray(self.lower)
        high = np.asarray(self.upper) - x
        to_all = np.stack([low, high], axis=2).reshape(len(x), 2 * self.dimension)
        return to_all[:, 1:] if self.axisymmetric else to_all

    def size(self) -> float:
        """Length of the diagonal."""
        return float(np.hypot.reduce(np.subtract(self.upper, self.lower)))

    def axis(self) -> tuple[float, float]:
        """From the bottom to the top."""
        return self.lower[1], self.upper[1]

    @property
    def volume(self) -> float:
        """Product of the sides."""
        return float(np.prod(np.subtract(self.upper, self.lower)))

    @property
    def mean_gradient(self) -> Array:
        """No mean flow."""
        return np.zeros((self.dimension, self.dimension))

    @property
    def middle(self) -> Array:
        """Between the corners."""
        return 0.5 * np.add(self.lower, self.upper)


@dataclass(frozen=True, slots=True)
class HalfPlane(Steady):
    """Half disc y > 0, |x| < radius, that stands for the half-plane above the wall `plane` (y = 0).

    The arc `far` carries the flow at infinity, at rest if not given. What the finite radius
    changes (the truncation) decays like (a / radius)^2 or faster and is reported by `fsi solve`.
    Axisymmetric, or with dimension = 3 and z for y, it is a half ball.
    """

    radius: float
    axisymmetric: bool = False
    dimension: int = 2

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of the walls."""
        return ("plane", "far")

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """The last axis for the plane, x for the arc where it meets the plane."""
        return (self.dimension - 1, 0)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to the plane and to the arc, shape (n, 2)."""
        return np.column_stack([x[:, -1], self.radius - lengths(x)])

    def size(self) -> float:
        """Diameter of the half disc."""
        return 2.0 * self.radius

    def axis(self) -> tuple[float, float]:
        """From the plane to the top of the arc."""
        return 0.0, self.radius

    @property
    def volume(self) -> float:
        """Of the half disc, the quarter of it, or the half ball."""
        whole = _ball_volume(self.radius, self.dimension)
        return whole / (4.0 if self.axisymmetric else 2.0)

    @property
    def mean_gradient(self) -> Array:
        """No mean flow."""
        return np.zeros((self.dimension, self.dimension))

    @property
    def middle(self) -> Array:
        """Half the radius above the plane."""
        middle: Array = 0.5 * self.radius * np.eye(self.dimension)[-1]
        return middle


@dataclass(frozen=True, slots=True)
class Round(Steady):
    """Disc |x| < radius with the one wall `far`; axisymmetric, or with dimension = 3, a ball.

    A small one is a round container; a large one stands for unbounded fluid.
    """

    radius: float
    axisymmetric: bool = False
    dimension: int = 2

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of the walls."""
        return ("far",)

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """It has no corners."""
        return (0,)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to the arc, shape (n, 1)."""
        return (self.radius - lengths(x))[:, None]

    def size(self) -> float:
        """Diameter."""
        return 2.0 * self.radius

    def axis(self) -> tuple[float, float]:
        """From the lowest to the highest point."""
        return -self.radius, self.radius

    @property
    def volume(self) -> float:
        """Of the disc, the half of it, or the ball."""
        whole = _ball_volume(self.radius, self.dimension)
        return whole / 2.0 if self.axisymmetric else whole

    @property
    def mean_gradient(self) -> Array:
        """No mean flow."""
        return np.zeros((self.dimension, self.dimension))

    @property
    def middle(self) -> Array:
        """The origin."""
        return np.zeros(self.dimension)


def _ball_volume(radius: float, dimension: int) -> float:
    return float(np.pi * radius**2 if dimension == 2 else 4.0 / 3.0 * np.pi * radius**3)
