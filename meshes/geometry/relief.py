"""Walls with a shape: of a straight wall a stretch follows a curve of heights over it.

With s along the wall, the fluid on its left, and y into the fluid, the surface is y = h(s) for s between
`begin` and `end`, and y = 0 elsewhere; there h and h' are zero, so that the tangent turns smoothly. What is
solid below the stretch is an outline like that of a body, closed by a stadium deep in the wall: nearest
points, normals and curvatures are its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.closed_curve import FEWEST
from fsi.meshes.geometry.curves import WallCurve, segment
from fsi.meshes.geometry.jets import ArcChain, Jet
from fsi.meshes.geometry.outline import Outline
from fsi.meshes.geometry.placed import Placed

TOP = 0.8  # of the parameter of the outline: the stretch
DEPTH = 2.0  # radius of the stadium's ends over the deepest dip, at least
PER_WAVE = 16  # points of the sample
SAME = 1e-12  # of the stretch: so near to a corner it begins there
FEWEST_ELEMENTS, LONGEST = 4, 0.25  # of a piece between joints


class Heights(NamedTuple):
    """A curve of heights over a straight wall.

    Attributes:
        interval: the places where it begins and ends.
        joints: places between these where derivatives jump, ascending.
        at: heights at places (n,), and their first two derivatives, (n,) each.
        lowest: the smallest height, 0 or less.
        waves: how often it goes up and down.
    """

    interval: tuple[float, float]
    joints: tuple[float, ...]
    at: Callable[[Array], tuple[Array, Array, Array]]
    lowest: float = 0.0
    waves: int = 1

    def mirrored(self) -> Heights:
        """The same over -s."""

        def at(s: Array) -> tuple[Array, Array, Array]:
            h, dh, ddh = self.at(-s)
            return h, -dh, ddh

        begin, end = self.interval
        joints = tuple(-s for s in self.joints[::-1])
        return Heights((-end, -begin), joints, at, self.lowest, self.waves)


class NearestOfWall(NamedTuple):
    """What points see of a wall where it is nearest to them.

    Attributes:
        distance: to it, negative in the wall, (n,).
        normal: of the wall there, into the fluid, (n, 2).
        bend: the radius that sizes of elements follow there, (n,); infinite where the wall is straight.
    """

    distance: Array
    normal: Array
    bend: Array


@dataclass(frozen=True, eq=False)
class Relief:
    """A stretch of a wall that follows such a curve.

    Attributes:
        wall: which of the container's walls has it.
        origin: the point s = 0 of the straight wall, (2,).
        along: the direction of s, a unit vector, (2,).
        interval: s where it begins and ends.
        joints: of s, both ends among them.
        outline: of what is solid below it, around its own centre of area.
        centre: that centre in (s, y), (2,).
        depth: how far the solid reaches at least below y = 0.
        wave: how far it is from crest to crest.
    """

    wall: int
    origin: Array
    along: Array
    interval: tuple[float, float]
    joints: Array
    outline: Outline
    centre: Array
    depth: float
    wave: float

    @classmethod
    def over(cls, curve: WallCurve, heights: Heights, axis: int) -> Relief:
        """Over a straight wall; places of the heights are coordinates along this axis."""
        step = curve.ends[1] - curve.ends[0]
        along = step / np.hypot(*step)
        if along[axis] < 0.0:
            heights = heights.mirrored()
        outline, depth = _solid(heights)
        origin = curve.ends[0] - (curve.ends[0] @ along) * along
        joints = np.array([heights.interval[0], *heights.joints, heights.interval[1]])
        centre, (begin, end) = outline.shift.copy(), heights.interval
        wave = (end - begin) / heights.waves
        return cls(curve.wall, origin, along, heights.interval, joints, outline, centre, depth, wave)

    @property
    def _frame(self) -> Array:
        """The directions of s and y as rows."""
        return np.array([self.along, [-self.along[1], self.along[0]]])

    @property
    def solid(self) -> Placed:
        """What is solid below the stretch, in its place."""
        angle = float(np.arctan2(self.along[1], self.along[0]))
        return Placed(self.outline, self.origin + self.centre @ self._frame, angle)

    def scaled(self, factor: float) -> Relief:
        """With all lengths times the factor."""
        begin, end = self.interval
        return replace(
            self,
            origin=factor * self.origin,
            interval=(factor * begin, factor * end),
            joints=factor * self.joints,
            outline=self.outline.scaled(factor),
            centre=factor * self.centre,
            depth=factor * self.depth,
            wave=factor * self.wave,
        )

    def seen_from(self, origin: Array) -> Relief:
        """In coordinates with this origin, (2,); s stays what it is."""
        return replace(self, origin=self.origin - origin)

    def nearest(self, x: Array) -> NearestOfWall:
        """What is nearest of the whole wall to points (n, 2), straight or not.

        In the wall distances are negative, and beside the stretch the depths below y = 0.
        """
        s, y = self._frame @ (x - self.origin).T
        solid = self.solid
        t = solid.nearest(x)
        normal, off = solid.normals(t), x - solid.at(t).x
        distance = np.copysign(np.hypot(*off.T), (off * normal).sum(axis=1))
        beside = (s < self.interval[0]) | (s > self.interval[1])
        flat = (beside & ((y <= np.abs(distance)) | (t >= TOP))) | (y < -self.depth)
        return NearestOfWall(
            np.where(flat, y, distance),
            np.where(flat[:, None], self._frame[1], normal),
            np.where(flat, np.inf, self.outline.bend(t)),
        )

    @property
    def area(self) -> float:
        """Between the stretch and the straight wall."""
        length = self.interval[1] - self.interval[0]
        return self.outline.area - self.depth * (2.0 * length + np.pi * self.depth)

    def pieces(self, straight: WallCurve) -> Iterator[WallCurve]:
        """The whole wall: the stretch from joint to joint, on both sides what is left of the straight one."""
        length = self.interval[1] - self.interval[0]
        t = TOP * (self.interval[1] - self.joints) / length
        solid, x = self.solid, self.origin + self.joints[:, None] * self.along
        x[1:-1] = solid.at(t[1:-1]).x
        for end, corner in ((0, straight.ends[0]), (-1, straight.ends[1])):
            if np.hypot(*(x[end] - corner)) <= SAME * length:
                x[end] = corner
        if np.any(x[0] != straight.ends[0]):
            yield segment(self.wall, straight.ends[0], x[0])
        for k in range(len(t) - 1):
            yield _piece(self.wall, solid, t[k : k + 2], x[k : k + 2])
        if np.any(x[-1] != straight.ends[1]):
            yield segment(self.wall, x[-1], straight.ends[1])


def close_places(heights: Heights) -> Array:
    """Places along a curve of heights between which it turns by little, ascending, both ends among them."""
    (begin, end), (outline, _) = heights.interval, _solid(heights)
    on_top = outline.t[outline.t < TOP]
    return np.append(begin, end - (end - begin) / TOP * on_top[::-1])


def _solid(heights: Heights) -> tuple[Outline, float]:
    """The outline below a curve of heights, counterclockwise, so from its end to its beginning; its depth."""
    (begin, end), rate = heights.interval, (heights.interval[1] - heights.interval[0]) / TOP
    length = end - begin
    depth = max(0.5 * length, -DEPTH * heights.lowest)
    lengths, bends = np.array([np.pi * depth, length, np.pi * depth]), np.array([1.0, 0.0, 1.0]) / depth
    below = ArcChain(lengths, bends, np.array([begin, 0.0]), np.pi)
    around = 1.0 / (1.0 - TOP)

    def above(t: Array) -> Jet:
        h, dh, ddh = heights.at(end - rate * t)
        one, zero = np.ones_like(t), np.zeros_like(t)
        place = np.column_stack([end - rate * t, h])
        return Jet(place, -rate * np.column_stack([one, dh]), rate**2 * np.column_stack([zero, ddh]))

    def jet(t: Array) -> Jet:
        on_top = (t < TOP)[:, None]
        x, dx, ddx = below(np.clip((t - TOP) * around, 0.0, 1.0))
        parts = zip(above(np.minimum(t, TOP)), (x, around * dx, around**2 * ddx), strict=True)
        return Jet(*(np.where(on_top, high, low) for high, low in parts))

    on_top = [TOP * (end - s) / length for s in heights.joints[::-1]]
    joints = (0.0, *on_top, *(TOP + (1.0 - TOP) * t for t in below.joints))
    return Outline.of(jet, joints, max(FEWEST, PER_WAVE * heights.waves)), depth


def _piece(wall: int, solid: Placed, ends_t: Array, ends: Array) -> WallCurve:
    """From one joint to the next, by the lengths of chords between points of the sample; t descends."""
    t = solid.outline.t
    t = np.concatenate([ends_t[:1], t[(t < ends_t[0]) & (t > ends_t[1])][::-1], ends_t[1:]])
    lengths = np.append(0.0, np.cumsum(np.hypot(*np.diff(solid.at(t).x, axis=0).T)))

    def at(s: Array) -> Array:
        return solid.at(np.interp(s, lengths, t)).x

    whole = float(lengths[-1])
    return WallCurve(wall, (0.0, whole), at, ends, LONGEST * whole, FEWEST_ELEMENTS, solid=solid)
