"""Domains of one's own whose walls end or are seen from outside: an L and an annulus."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, override

import numpy as np
from pydantic import Field

from fsi.arrays import Array
from fsi.case.domains.domain import Walled
from fsi.case.section import Geometry
from fsi.meshes.geometry.container import Container, lengths
from fsi.meshes.geometry.curves import Sphere, WallCurve, arc, segment


@dataclass(frozen=True, slots=True)
class Elbow(Container):
    """The square [0, length]^2 without the square of side length - width at its upper right."""

    length: float
    width: float
    walls: ClassVar[tuple[str, ...]] = ("bottom", "right", "shelf", "inner", "top", "left")

    @property
    def corners(self) -> Array:
        L, w = self.length, self.width
        return np.array([[0.0, 0.0], [L, 0.0], [L, w], [w, w], [w, L], [0.0, L]])

    def to_segments(self, x: Array) -> tuple[Array, Array]:
        """Distances of points inside to the nearest points of walls, and the normals there."""
        start = self.corners
        side = np.roll(start, -1, axis=0) - start
        part = np.einsum("nkd,kd->nk", x[:, None] - start, side) / np.sum(side**2, axis=1)
        away = x[:, None] - start - np.clip(part, 0.0, 1.0)[..., None] * side
        distance = np.linalg.norm(away, axis=2)
        left = np.column_stack([-side[:, 1], side[:, 0]]) / np.linalg.norm(side, axis=1)[:, None]
        on_wall = distance[..., None] < 1e-12 * self.length
        return distance, np.where(on_wall, left, away / np.where(on_wall, 1.0, distance[..., None]))

    def distances(self, x: Array) -> Array:
        """Negative outside the L."""
        within = ((x >= 0.0) & (x <= self.length)).all(axis=1) & (x <= self.width).any(axis=1)
        away: Array = np.where(within, 1.0, -1.0)[:, None] * self.to_segments(x)[0]
        return away

    def normals(self, x: Array) -> Array:
        return self.to_segments(x)[1]

    def outline(self) -> tuple[WallCurve, ...]:
        corners = self.corners
        return tuple(segment(k, corners[k], corners[(k + 1) % 6]) for k in range(6))

    def size(self) -> float:
        return float(2.0**0.5 * self.length)

    @property
    def volume(self) -> float:
        return float(self.length**2 - (self.length - self.width) ** 2)


@dataclass(frozen=True, slots=True)
class Annulus(Container):
    """What lies between two circles around the origin."""

    inner: float
    outer: float
    walls: ClassVar[tuple[str, ...]] = ("inside", "outside")

    def distances(self, x: Array) -> Array:
        return np.column_stack([lengths(x) - self.inner, self.outer - lengths(x)])

    def normals(self, x: Array) -> Array:
        outwards = x / lengths(x)[:, None]
        return np.stack([outwards, -outwards], axis=1)

    def outline(self) -> tuple[WallCurve, ...]:
        R, half = self.inner, np.pi * self.inner

        def clockwise(s: Array) -> Array:
            return R * np.column_stack([np.cos(s / R), -np.sin(s / R)])

        ends = np.array([[R, 0.0], [-R, 0.0]])
        pieces = (((0.0, half), ends), ((half, 2.0 * half), ends[::-1]))
        within = (WallCurve(0, at, clockwise, ends, 0.5 * R, 8, np.zeros(2)) for at, ends in pieces)
        return *within, arc(1, self.outer, 0.0, np.pi), arc(1, self.outer, np.pi, 2.0 * np.pi)

    @property
    def spheres(self) -> tuple[Sphere | None, ...]:
        return Sphere(np.zeros(2), self.inner), Sphere(np.zeros(2), self.outer)

    def size(self) -> float:
        return 2.0 * self.outer

    @property
    def volume(self) -> float:
        return float(np.pi * (self.outer**2 - self.inner**2))


class ElbowDomain(Walled):
    shape: Literal["elbow-of-tests"]
    length: float = Field(gt=0.0, description="the outer side, a number > 0")
    width: float = Field(gt=0.0, description="the width of the arms, a number > 0")

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        return Elbow.walls

    @override
    def container(self) -> Container:
        return Elbow(self.length, self.width)


class AnnulusDomain(Walled):
    shape: Literal["annulus-of-tests"]
    inner: float = Field(gt=0.0, description="the inner radius, a number > 0")
    outer: float = Field(gt=0.0, description="the outer radius, a number > 0")

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        return Annulus.walls

    @override
    def container(self) -> Container:
        return Annulus(self.inner, self.outer)
