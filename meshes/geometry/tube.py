"""The round tube in space, with both ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import Container, lengths
from fsi.meshes.geometry.curves import Cylinder, Sphere, rescaled

SIDES = 96  # of a ring in pictures


@dataclass(frozen=True, slots=True)
class Tube(Container):
    """The cylinder x^2 + y^2 < radius^2, |z| < length / 2 with the walls bottom, top and side.

    The side comes last: where it meets an end, it gives both components of the velocity across the axis.
    """

    radius: float
    length: float
    dimension: ClassVar[int] = 3
    walls: ClassVar[tuple[str, ...]] = ("bottom", "top", "side")

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """The axis for both ends; the side has a normal of its own everywhere, see the class."""
        return (2, 2, 0)

    def meetings(self) -> dict[tuple[int, int], Array]:
        """The side meets each end on a circle: one point of it."""
        half = 0.5 * self.length
        return {(end, 2): np.array([[self.radius, 0.0, z]]) for end, z in enumerate((-half, half))}

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, 3) to both ends and the side, shape (n, 3)."""
        half = 0.5 * self.length
        return np.column_stack([x[:, 2] + half, half - x[:, 2], self.radius - lengths(x[:, :2])])

    def normals(self, x: Array) -> Array:
        """Along the axis from the ends, towards it from the side; zero there on it."""
        normals = np.zeros((len(x), 3, 3))
        normals[:, 0, 2], normals[:, 1, 2] = 1.0, -1.0
        length = lengths(x[:, :2])[:, None]
        normals[:, 2, :2] = -x[:, :2] / np.where(length > 0.0, length, 1.0)
        return normals

    @property
    def edges(self) -> Array:
        """Rings about a radius apart and four lines along the side, (n, 2, 3)."""
        turn, half = np.linspace(0.0, 2.0 * np.pi, SIDES + 1), 0.5 * self.length
        heights = np.linspace(-half, half, max(2, round(self.length / self.radius) + 1))
        ring = self.radius * np.column_stack([np.cos(turn), np.sin(turn), np.zeros(len(turn))])
        rings = ring + heights[:, None, None] * np.eye(3)[2]
        along = np.stack([rings[0, : -1 : SIDES // 4], rings[-1, : -1 : SIDES // 4]], axis=1)
        return np.concatenate([np.stack([rings[:, :-1], rings[:, 1:]], axis=2).reshape(-1, 2, 3), along])

    @property
    def spheres(self) -> tuple[Sphere | None, ...]:
        """The side is a cylinder."""
        return None, None, Cylinder(np.zeros(3), self.radius)

    def wall_fluxes(self) -> Array:
        """The area of each end; of n_i x_i the volume, on both ends together and on the side."""
        area = np.pi * self.radius**2
        fluxes = np.zeros((3, 3, 4))
        fluxes[:2, 2, 0] = -area, area
        fluxes[:2, 2, 3] = 0.5 * self.volume
        fluxes[2, 0, 1] = fluxes[2, 1, 2] = self.volume
        return fluxes

    def size(self) -> float:
        """Length of the diagonal."""
        return float(np.hypot(2.0 * self.radius, self.length))

    @property
    def volume(self) -> float:
        """Of the cylinder."""
        return float(np.pi * self.radius**2 * self.length)

    def scaled(self, factor: float) -> Self:
        """Both lengths times the factor."""
        return type(self)(*rescaled([self.radius, self.length], factor).tolist())

    def solid(self, kernel: Any) -> int:
        """A cylinder."""
        return int(kernel.addCylinder(0.0, 0.0, -0.5 * self.length, 0.0, 0.0, self.length, self.radius))

    def distance_formulas(self) -> list[str]:
        """Heights over the ends, and the radius less the distance from the axis."""
        half = 0.5 * self.length
        return [f"(z+{half!r})", f"({half!r}-z)", f"({self.radius!r}-sqrt(x^2+y^2))"]
