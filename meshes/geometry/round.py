"""Round containers, and the half-plane, which a half of a large one stands for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import Container, lengths
from fsi.meshes.geometry.curves import Sphere, WallCurve, arc, rescaled, segment


@dataclass(frozen=True, slots=True)
class Round(Container):
    """Disc |x| < radius with the one wall `far`; axisymmetric, or with dimension = 3, a ball.

    A small one is a round container; a large one stands for unbounded fluid.
    """

    radius: float
    axisymmetric: bool = False
    dimension: int = 2
    walls: ClassVar[tuple[str, ...]] = ("far",)

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """It has no corners."""
        return (0,)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to the arc, shape (n, 1)."""
        return self.radius - lengths(x)[:, None]

    def normals(self, x: Array) -> Array:
        """Towards the origin; zero there, where every direction is as good."""
        length = np.linalg.norm(x, axis=1, keepdims=True)
        inward: Array = -x / np.where(length > 0.0, length, 1.0)
        return inward[:, None]

    def outline(self) -> tuple[WallCurve, ...]:
        """Two arcs, with an axis the right one."""
        halves = [(-0.5, 0.5)] if self.axisymmetric else [(-0.5, 0.5), (0.5, 1.5)]
        return tuple(arc(0, self.radius, start * np.pi, end * np.pi) for start, end in halves)

    @property
    def spheres(self) -> tuple[Sphere | None, ...]:
        """Its only or last wall is round."""
        return *(None for _ in self.walls[1:]), Sphere(np.zeros(self.dimension), self.radius)

    @property
    def concavities(self) -> tuple[int, ...]:
        """That has the fluid within it."""
        return *(0 for _ in self.walls[1:]), 1

    def wall_fluxes(self) -> Array:
        """A linear flow leaves as it enters."""
        return np.zeros((1, self.dimension, self.dimension + 1))

    def size(self) -> float:
        """Diameter."""
        return 2.0 * self.radius

    @property
    def volume(self) -> float:
        """Of the whole disc or ball, with an axis of half the disc."""
        whole = np.pi * self.radius**2 if self.dimension == 2 else 4.0 / 3.0 * np.pi * self.radius**3
        return float(whole) / (2.0 if self.axisymmetric else 1.0)

    @property
    def volume_in_space(self) -> float:
        """With an axis of a ball, or half of one."""
        return replace(self, axisymmetric=False, dimension=3).volume if self.axisymmetric else self.volume

    def scaled(self, factor: float) -> Self:
        """The radius times the factor."""
        return replace(self, radius=float(rescaled(self.radius, factor)))

    def solid(self, kernel: Any) -> int:
        """A ball."""
        return int(kernel.addSphere(0.0, 0.0, 0.0, self.radius))

    def distance_formulas(self) -> list[str]:
        """The radius less the distance from the origin."""
        return [f"({self.radius!r}-sqrt(x^2+y^2+z^2))"]


@dataclass(frozen=True, slots=True)
class HalfPlane(Round):
    """Half disc y > 0, |x| < radius, that stands for the half-plane above the wall `plane` (y = 0).

    The arc `far` carries the flow at infinity, at rest if not given. What the finite radius
    changes (the truncation) decays like (a / radius)^2 or faster and is reported by `fsi solve`.
    Axisymmetric, or with dimension = 3 and z for y, it is a half ball.
    """

    walls: ClassVar[tuple[str, ...]] = ("plane", "far")
    far_walls: ClassVar[tuple[str, ...]] = ("far",)

    def meetings(self) -> dict[tuple[int, int], Array]:
        """Plane and arc meet at its ends, in space on a circle: one point of it."""
        return {(0, 1): np.array([[self.radius, 0.0, 0.0]])} if self.dimension == 3 else Round.meetings(self)

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """The last axis for the plane, x for the arc where it meets the plane."""
        return (self.dimension - 1, 0)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to the plane and to the arc, shape (n, 2)."""
        return np.column_stack([x[:, -1], Round.distances(self, x)])

    def normals(self, x: Array) -> Array:
        """Upwards from the plane, towards the origin from the arc."""
        upwards = np.broadcast_to(np.eye(self.dimension)[-1], x.shape)
        return np.concatenate([upwards[:, None], Round.normals(self, x)], axis=1)

    def outline(self) -> tuple[WallCurve, ...]:
        """From the left end of the plane to the right, and back on the arc; with an axis half of each."""
        left, turn = (0.0, 0.5 * np.pi) if self.axisymmetric else (-self.radius, np.pi)
        return segment(0, (left, 0.0), (self.radius, 0.0)), arc(1, self.radius, 0.0, turn)

    def wall_fluxes(self) -> Array:
        """What enters through the plane leaves through the arc."""
        disc = self.axisymmetric or self.dimension == 3
        fluxes = np.zeros((2, self.dimension, self.dimension + 1))
        fluxes[1, -1, 0] = np.pi * self.radius**2 if disc else 2.0 * self.radius
        fluxes[0] = -fluxes[1]
        return fluxes

    @property
    def volume(self) -> float:
        """Of the half disc, the quarter of it, or the half ball."""
        return Round(self.radius, self.axisymmetric, self.dimension).volume / 2.0

    def solid(self, kernel: Any) -> int:
        """The northern half of a ball."""
        return int(kernel.addSphere(0.0, 0.0, 0.0, self.radius, angle1=0.0))

    def distance_formulas(self) -> list[str]:
        """z, and the radius less the distance from the origin."""
        return ["z", *Round.distance_formulas(self)]

    @property
    def middle(self) -> Array:
        """Half the radius above the plane."""
        middle: Array = 0.5 * self.radius * np.eye(self.dimension)[-1]
        return middle
