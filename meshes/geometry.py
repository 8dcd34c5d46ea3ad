"""The containers that hold fluid and bodies, as plain NumPy geometry.

A container knows its walls by name, how far a point lies from each of them, and nothing of
meshes or physics. Lengths are in the user's unit; points are arrays of shape (n, 2).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Container(Protocol):
    """What encloses the fluid."""

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of the walls, in the order of every array over walls."""

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """For each wall the axis of its normal at its corners, where that velocity component is its own."""

    def distances(self, x: Array) -> Array:
        """Distance of each point to each wall, shape (n, walls); positive inside."""

    def size(self) -> float:
        """A length that no distance inside exceeds."""


@dataclass(frozen=True, slots=True)
class Box:
    """Rectangle [lower, upper] with walls left, right, bottom, top.

    A channel is a long box whose left and right ends are open.
    """

    lower: tuple[float, float]
    upper: tuple[float, float]

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of the walls."""
        return ("left", "right", "bottom", "top")

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """x for left and right, y for bottom and top."""
        return (0, 0, 1, 1)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, 2) to left, right, bottom, top, shape (n, 4)."""
        low = x - np.asarray(self.lower)
        high = np.asarray(self.upper) - x
        return np.column_stack([low[:, 0], high[:, 0], low[:, 1], high[:, 1]])

    def size(self) -> float:
        """Length of the diagonal."""
        return float(np.hypot(*np.subtract(self.upper, self.lower)))


@dataclass(frozen=True, slots=True)
class HalfPlane:
    """Half disc y > 0, |x| < radius, that stands for the half-plane above the wall `plane` (y = 0).

    The arc `far` carries the flow at infinity, at rest if not given. What the finite radius
    changes (the truncation) decays like (a / radius)^2 and is reported by `fsi solve`.
    """

    radius: float

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of the walls."""
        return ("plane", "far")

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """y for the plane, x for the arc where it meets the plane."""
        return (1, 0)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, 2) to the plane and to the arc, shape (n, 2)."""
        return np.column_stack([x[:, 1], self.radius - np.hypot(x[:, 0], x[:, 1])])

    def size(self) -> float:
        """Diameter of the half disc."""
        return 2.0 * self.radius
