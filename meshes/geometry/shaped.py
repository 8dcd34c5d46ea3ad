"""A container of which some straight walls have a shape."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fsi.arrays import Array
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.curves import Sphere, WallCurve
from fsi.meshes.geometry.derived import DerivedContainer
from fsi.meshes.geometry.relief import Heights, Relief


@dataclass(frozen=True, slots=True, eq=False)
class ShapedWalls(DerivedContainer):
    """Another container in the plane, whose walls `reliefs` name are not straight but follow these.

    Attributes:
        inner: the container with straight walls.
        reliefs: one for each wall with a shape.
    """

    reliefs: tuple[Relief, ...]

    @classmethod
    def of(cls, inner: Container, shapes: Mapping[str, Heights]) -> ShapedWalls:
        """With the walls of these names following heights into the fluid."""
        curves, axes = {curve.wall: curve for curve in inner.outline()}, inner.corner_axes
        walls = {inner.walls.index(name): heights for name, heights in shapes.items()}
        return cls(inner, tuple(Relief.over(curves[k], h, 1 - axes[k]) for k, h in walls.items()))

    @property
    def spheres(self) -> tuple[Sphere | None, ...]:
        """As before."""
        return self.inner.spheres

    @property
    def plane(self) -> tuple[bool, ...]:
        """Not those with a shape."""
        shaped = {relief.wall for relief in self.reliefs}
        return tuple(flat and k not in shaped for k, flat in enumerate(self.inner.plane))

    @property
    def faces(self) -> Mapping[str, tuple[int, float]]:
        """Those that are plane."""
        plane = dict(zip(self.walls, self.plane, strict=True))
        return {name: face for name, face in self.inner.faces.items() if plane[name]}

    def meetings(self) -> dict[tuple[int, int], Array]:
        """As before."""
        return self.inner.meetings()

    def wall_fluxes(self) -> Array:
        """As before: they depend on the corners alone."""
        return self.inner.wall_fluxes()

    def distances(self, x: Array) -> Array:
        """To the shaped walls, and as before to the others."""
        away = self.inner.distances(x).copy()
        for relief in self.reliefs:
            away[:, relief.wall] = relief.nearest(x).distance
        return away

    def normals(self, x: Array) -> Array:
        """Of the shaped walls where they are nearest, and as before of the others."""
        normals = self.inner.normals(x).copy()
        for relief in self.reliefs:
            normals[:, relief.wall] = relief.nearest(x).normal
        return normals

    def to_wall(self, wall: int, x: Array) -> tuple[Array, Array]:
        """Both of one wall alone."""
        for relief in self.reliefs:
            if relief.wall == wall:
                nearest = relief.nearest(x)
                return nearest.distance, nearest.normal
        return self.inner.to_wall(wall, x)

    @property
    def waves(self) -> tuple[float, ...]:
        """Of the shaped walls theirs."""
        waves = list(self.inner.waves)
        for relief in self.reliefs:
            waves[relief.wall] = relief.wave
        return tuple(waves)

    def bends(self, x: Array) -> Array:
        """Of the shaped walls where they are nearest."""
        bends = self.inner.bends(x)
        for relief in self.reliefs:
            bends[:, relief.wall] = relief.nearest(x).bend
        return bends

    def outline(self) -> tuple[WallCurve, ...]:
        """The pieces of the shaped walls in place of the straight ones."""
        shaped = {relief.wall: relief for relief in self.reliefs}
        return tuple(
            piece
            for curve in self.inner.outline()
            for piece in (shaped[curve.wall].pieces(curve) if curve.wall in shaped else (curve,))
        )

    def size(self) -> float:
        """With the depths below walls."""
        return self.inner.size() + sum(relief.depth for relief in self.reliefs)

    @property
    def volume(self) -> float:
        """Less what stands over the straight walls."""
        return self.inner.volume - sum(relief.area for relief in self.reliefs)

    @property
    def middle(self) -> Array:
        """As before."""
        return self.inner.middle

    def scaled(self, factor: float) -> ShapedWalls:
        """Both."""
        return ShapedWalls(self.inner.scaled(factor), tuple(relief.scaled(factor) for relief in self.reliefs))

    def seen_from(self, origin: Array) -> ShapedWalls | None:
        """Both; None where the other's shape stands at its own origin."""
        inner = self.inner.seen_from(origin)
        if inner is None:
            return None
        return ShapedWalls(inner, tuple(relief.seen_from(origin) for relief in self.reliefs))
