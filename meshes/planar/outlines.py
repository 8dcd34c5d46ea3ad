"""The nodes around bodies of which some are no discs: on their true outlines.

Sizes are those of `sizing`, with the radius of the curvature there, and of what is opposite, for that of a
disc. Nodes stand where derivatives of an outline jump, and where the narrowest gap of a body is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor

import numpy as np

from fsi.arrays import Array, Indices
from fsi.meshes.errors import MeshError, TouchingError
from fsi.meshes.geometry.closed_curve import AT_JOINT
from fsi.meshes.geometry.feet import Foot
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.wall_feet import wall_feet
from fsi.meshes.planar.sizing import Curve, Surfaces
from fsi.meshes.planar.spread import resolve_all, spread
from fsi.meshes.resolution import SHORTEST

FEWEST = 8  # elements around a body


def outline_rings(surfaces: Surfaces, bodies: Sequence[int]) -> list[Curve]:
    """The nodes around these bodies, with an axis from end to end.

    Raises TouchingError where one touches another or a wall.
    """
    return [_ring(surfaces, i) for i in bodies]


def _ring(surfaces: Surfaces, i: int) -> Curve:
    near = _Near.of(surfaces, i)
    narrowest, poles = near.narrowest(), near.body.outline.poles
    if poles is None:
        start = narrowest or 0.0
        t, x, normal = (values[:-1] for values in near.nodes(start, start + 1.0))
    else:
        t, x, normal = near.nodes(*poles, [] if narrowest is None else [narrowest])
        x[[0, -1]], normal[[0, -1], 0] = surfaces.on_axis(i), 0.0
    return Curve(i + 1, x, poles is None, opening=near.opening(t, x, normal), body=near.body)


def outline_arcs(surfaces: Surfaces, bodies: Sequence[int], angles: Array) -> list[Curve]:
    """The nodes on bodies between two angles 2 pi t each, start < end, (n, 2)."""
    arcs = []
    for i, (start, end) in zip(bodies, angles / (2.0 * np.pi), strict=True):
        if end - start < AT_JOINT:
            place = surfaces.centres[i]
            raise MeshError("two narrowest gaps of the body at {} are at the same place; move it", place)
        near = _Near.of(surfaces, i)
        t, x, normal = near.nodes(start, end)
        arcs.append(Curve(i + 1, x, False, opening=near.opening(t, x, normal), body=near.body))
    return arcs


@dataclass(frozen=True, slots=True, eq=False)
class _Near:
    """A body and what is so near to it that it has smaller elements there.

    Attributes:
        body: where it is.
        others: the bodies and images near it.
        reach: the gap up to which it has smaller elements.
        surfaces: all of them.
    """

    body: Placed
    others: list[Placed]
    reach: float
    surfaces: Surfaces

    @staticmethod
    def of(surfaces: Surfaces, i: int) -> _Near:
        """Of body i."""
        resolution = surfaces.resolution
        reach = float(resolution.cells_per_gap * resolution.on_body(surfaces.radii[i]) / SHORTEST)
        gaps = np.hypot(*(surfaces.centres - surfaces.centres[i]).T) - surfaces.radii - surfaces.radii[i]
        gaps[i] = np.inf
        others = [surfaces.placed[j] for j in np.flatnonzero(gaps < reach)]
        return _Near(surfaces.placed[i], others, reach, surfaces)

    def beside(self, t: Array, x: Array) -> tuple[Array, Array]:
        """The width of the gap at points x of the outline, and the smaller radius beside it."""
        container = self.surfaces.container
        to_walls = container.distances(x)
        gap, radius = to_walls.min(axis=1, initial=np.inf), self.body.outline.bend(t)
        if not all(container.plane):
            nearest = to_walls.argmin(axis=1)
            radius = np.minimum(radius, container.bends(x)[np.arange(len(x)), nearest])
        for other in self.others:
            distance, bend = other.distance_and_bend(x)
            radius = np.where(distance < gap, np.minimum(radius, bend), radius)
            gap = np.minimum(gap, distance)
        return gap, radius

    def size(self, t: Array, _: Indices) -> Array:
        """Of elements, by t."""
        outline, resolution = self.body.outline, self.surfaces.resolution
        x, dx, _ddx = self.body.at(t)
        in_gap = resolution.across(*self.beside(t, x))
        sizes: Array = np.minimum(in_gap, resolution.on_body(outline.bend(t)))
        sizes /= np.hypot(*dx.T)
        return sizes

    def nodes(self, start: float, end: float, fixed: Sequence[float] = ()) -> tuple[Array, Array, Array]:
        """From t = start to end, at joints between and other fixed t: (n,), places and normals, (n, 2)."""
        breaks = self.breaks(start, end, fixed)
        ends, resolution = np.column_stack([breaks[:-1], breaks[1:]]), self.surfaces.resolution
        t, h, piece = resolve_all(self.size, ends, resolution.cells_per_circle)
        placed = [
            spread(t[piece == k], h[piece == k], (), FEWEST * length)[:-1]
            for k, length in enumerate(np.diff(breaks))
        ]
        t = np.concatenate([*placed, [end]])
        return t, self.body.at(t).x, self.body.normals(t)

    def breaks(self, start: float, end: float, fixed: Sequence[float]) -> Array:
        """Where nodes must stand, ascending."""
        turns, stops = range(floor(start), ceil(end) + 1), (*self.body.outline.joints, *fixed)
        every = [turn + t for t in (*stops, *self._tips([start, end, *stops])) for turn in turns]
        inner = np.sort(every)
        apart = (inner > start + AT_JOINT) & (inner < end - AT_JOINT)
        apart[1:] &= np.diff(inner) > AT_JOINT
        return np.concatenate([[start], inner[apart], [end]])

    def _tips(self, stops: Sequence[float]) -> list[float]:
        """The t of sharp tips, but of those where a stop is: an element that goes around one turns over."""
        outline = self.body.outline
        if not outline.tips:
            return []
        tips = np.array(outline.tips)
        away = np.linalg.norm(self.body.at(tips).x[:, None] - self.body.at(np.array(stops)).x, axis=2)
        apart = away.min(axis=1) > 0.5 * self.surfaces.resolution.on_body(outline.bend(tips))
        return [float(t) for t in tips[apart]]

    def opening(self, t: Array, x: Array, normal: Array) -> Array:
        """Into the body, where a gap beside it is opened, (n, 2)."""
        half: Array = 0.5 * self.surfaces.resolution.opened(*self.beside(t, x))
        return -half[:, None] * normal

    def narrowest(self) -> float | None:
        """The t of its narrowest gap, of a joint if one is there; None if all gaps are wide."""
        feet: list[Foot] = [self.body.gap_to(other) for other in self.others]
        feet += wall_feet(self.body, self.surfaces.container)
        narrowest = min(feet, key=lambda foot: foot.gap, default=None)
        if narrowest is None or narrowest.gap >= self.reach:
            return None
        if narrowest.gap <= 0.0:
            raise TouchingError("the body at {} touches a body or wall; move it", self.body.centre)
        t = narrowest.t
        if self.body.outline.poles is not None:  # of two mirror images the one with r > 0
            t = float(self.body.nearest(np.abs(narrowest.x[None]) * [1.0, np.sign(narrowest.x[1])])[0])
        return self.body.outline.snapped(t)
