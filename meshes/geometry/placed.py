"""Bodies of any outline where they stand, and the gaps between them by closest points.

The gap between a body and what is opposite, a wall or another body with the signed distance f and its
gradient n, is the least f over the outline x(t): there  n(x(t)) . x'(t) = 0.  It is negative where they
overlap, also where one lies within the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.feet import Foot, Opposite, Sampled, low_points, root, separate
from fsi.meshes.geometry.jets import Jet
from fsi.meshes.geometry.normals import CommonNormals, common_normals
from fsi.meshes.geometry.outline import Outline

PER_WAVE = 8  # points of a sample beside waves of a wall
ROUND = 1e-9  # of the radius, by which bends of a circle are off it
FINER = 0.5  # spacing over spacing, below which the other sample is taken


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """An outline around a centre (2,), turned by an angle."""

    outline: Outline
    centre: Array
    angle: float

    def moved(self, centre: Array) -> Placed:
        """The same body around another centre (2,)."""
        return Placed(self.outline, centre, self.angle)

    def scaled(self, factor: float) -> Placed:
        """The same with all lengths times the factor, its place too."""
        return Placed(self.outline.scaled(factor), factor * self.centre, self.angle)

    @property
    def inside(self) -> Array:
        """A point inside, (2,)."""
        return np.asarray(self.centre + self.outline.inside @ self._rows)

    def between(self, start: float, end: float) -> Array:
        """Some points from t = start to end, both included, start < end, (n, 2)."""
        t = np.concatenate([k + self.outline.t for k in range(int(np.floor(start)), int(np.ceil(end)))])
        return self.at(np.concatenate([[start], t[(t > start) & (t < end)], [end]])).x

    @property
    def _rows(self) -> Array:
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, s], [-s, c]])  # x @ rows turns x by the angle

    def at(self, t: Array) -> Jet:
        """Points and derivatives at t (n,)."""
        x, dx, ddx = self.outline.jet(t)
        rows = self._rows
        with np.errstate(invalid="ignore"):  # infinite at the end of a tip
            return Jet(self.centre + x @ rows, dx @ rows, ddx @ rows)

    def drawn(self, points: int) -> Array:
        """Some points around it, (points, 2), close to each other where it bends."""
        t = self.outline.t
        return self.at(
            np.interp(np.arange(points) / points, np.arange(len(t) + 1) / len(t), np.append(t, 1.0))
        ).x

    def normals(self, t: Array) -> Array:
        """Out of the body at t (n,), (n, 2)."""
        dx = self.at(t).dx
        normal: Array = np.column_stack([dx[:, 1], -dx[:, 0]]) / np.hypot(*dx.T)[:, None]
        return normal

    @property
    def is_round(self) -> bool:
        """Whether sizes of elements that follow its bends are those along a circle."""
        outline = self.outline
        return float(outline.bend(outline.t).min()) > (1.0 - ROUND) * outline.radius

    def seen(self, x: Array) -> Array:
        """Points (n, 2) as the body sees them."""
        return np.asarray((x - self.centre) @ self._rows.T)

    def nearest(self, x: Array) -> Array:
        """The t of the points nearest to x (n, 2)."""
        return self.outline.nearest(self.seen(x))

    def signed_distance(self, x: Array) -> tuple[Array, Array]:
        """Distance of points (n, 2) to the body, negative inside, (n,), and its gradient, (n, 2)."""
        distance, normal = self.outline.signed_distance(self.seen(x))
        return distance, normal @ self._rows

    def distance_and_bend(self, x: Array) -> tuple[Array, Array]:
        """Distance of points (n, 2) outside to the body, and its `bend` where it is nearest, (n,) each."""
        seen = self.seen(x)
        t = self.outline.nearest(seen)
        return np.hypot(*(seen - self.outline.jet(t).x).T), self.outline.bend(t)

    def gap_to_surface(self, opposite: Opposite, wave: float) -> Foot:
        """The gap to a surface with this signed distance and gradient, and so far from crest to crest."""
        return self._foot(opposite, self._sampled(opposite, 0.0, wave))

    def feet_on(self, opposite: Opposite, reach: float, wave: float) -> list[Foot]:
        """All its gaps up to `reach`, and the narrowest, which comes first."""
        sampled = self._sampled(opposite, reach, wave)
        return self._apart(self._foot(opposite, sampled), self._feet(opposite, sampled, reach), sampled)

    def feet_to(self, other: Placed, reach: float) -> list[Foot]:
        """All gaps to another body up to `reach`, and the narrowest, which comes first."""
        narrowest, spacing = self.gap_to(other), self.outline.spacing + other.outline.spacing
        if (self.outline.is_convex and other.outline.is_convex) or narrowest.gap > reach:
            return [narrowest]
        if other.outline.spacing < self.outline.spacing:  # along whose sample none is overlooked
            feet = [self._seen_from_here(foot) for foot in other.feet_to(self, reach)]
            return [narrowest, *feet[1:]]
        x = self._sample()
        near = other.outline.coarse_distance(other.seen(x))[0] <= reach + spacing
        distance = np.full(len(x), np.inf)
        distance[near] = other.signed_distance(x[near])[0]
        sampled = Sampled(self.outline.t, distance)
        return self._apart(narrowest, self._feet(other.signed_distance, sampled, reach), sampled)

    def _sampled(self, opposite: Opposite, reach: float, wave: float) -> Sampled:
        """f at the sample, which is made finer than waves of what is opposite where that is near."""
        t, spacing = self.outline.t, self.outline.spacing
        distance = opposite(self._sample())[0]
        parts = int(np.ceil(PER_WAVE * spacing / wave))
        if parts < 2:
            return Sampled(t, distance)
        near = np.minimum(distance, np.roll(distance, -1)) <= max(reach, float(distance.min())) + spacing
        here, step = t[near], np.diff(t, append=1.0)[near]
        between = (here[:, None] + step[:, None] * np.arange(1, parts) / parts).ravel()
        every = np.concatenate([t, between])
        order = np.argsort(every)
        return Sampled(every[order], np.append(distance, opposite(self.at(between).x)[0])[order])

    def _apart(self, narrowest: Foot, feet: list[Foot], sampled: Sampled) -> list[Foot]:
        """The narrowest foot, and others between which the distance rises, of mirror images one.

        What is opposite lies outside of the body there: beyond its far side there is none.
        """
        if narrowest.gap <= 0.0:
            return [narrowest]
        facing = [foot for foot in feet if self.normals(np.array([foot.t]))[0] @ foot.normal < 0.0]
        chosen = list(separate(narrowest, facing, sampled))
        if self.outline.poles is None:
            return chosen
        return [foot for k, foot in enumerate(chosen) if not any(map(foot.mirrors, chosen[:k]))]

    def _seen_from_here(self, foot: Foot) -> Foot:
        """A foot of another body on this one as a foot of this one."""
        x = foot.opposite
        return Foot(foot.gap, float(self.nearest(x[None])[0]), x, 0.0 - foot.normal)

    def gap_to(self, other: Placed) -> Foot:
        """The gap to another body, found along the outline of the finer sample."""
        if other.outline.spacing < FINER * self.outline.spacing:
            return self._seen_from_here(other.gap_to(self))
        x, spacing = self._sample(), self.outline.spacing + other.outline.spacing
        coarse, beside = other.outline.coarse_distance(other.seen(x))
        lowest = (coarse <= np.roll(coarse, 1)) & (coarse <= np.roll(coarse, -1))
        lowest &= coarse <= coarse.min() + spacing
        normals = common_normals(self.at, other.at, self.outline.t[lowest], beside[lowest], 2.0 * spacing)
        if normals is not None:
            return self._facing(normals, other)
        near = np.flatnonzero(coarse <= coarse.min() + spacing)
        distance, normal = np.full(len(x), np.inf), other.signed_distance
        distance[near] = normal(x[near])[0]
        inside = other.at(np.zeros(1)).x
        if self.signed_distance(inside)[0][0] < 0.0 < distance.min():
            depth, out = self.signed_distance(inside)
            return Foot(float(depth[0]), float(self.nearest(inside)[0]), inside[0], -out[0])
        return self._foot(other.signed_distance, Sampled(self.outline.t, distance))

    def _facing(self, normals: CommonNormals, other: Placed) -> Foot:
        """The gap along the shortest of some common normals."""
        k = int(np.argmin(normals.gap))
        out = other.normals(normals.s[k : k + 1])[0]
        return Foot(float(normals.gap[k]), float(normals.t[k] % 1.0), self.at(normals.t[k : k + 1]).x[0], out)

    def _sample(self) -> Array:
        return np.asarray(self.centre + self.outline.sample.x @ self._rows)

    def _foot(self, opposite: Opposite, sampled: Sampled) -> Foot:
        """Where f is least, from its values at a sample."""
        feet = self._feet(opposite, sampled, float(sampled.distance.min()) + self.outline.spacing)
        return min(feet, key=lambda foot: foot.gap)

    def _feet(self, opposite: Opposite, sampled: Sampled, highest: float) -> list[Foot]:
        """The same of all local minima up to some value, each twice where it is at a point of the sample."""
        t, low_ones = sampled.t, low_points(sampled.distance, highest)
        closed = np.concatenate([[t[-1] - 1.0], t, [1.0]])
        here = closed[low_ones + 1]
        slope = self._slope(opposite, here)
        low, high = (
            np.where(slope > 0.0, closed[low_ones], here),
            np.where(slope > 0.0, here, closed[low_ones + 2]),
        )
        tried = np.concatenate([here, root(lambda t: self._slope(opposite, t), low, high)])
        x = self.at(tried).x
        gaps, normals = opposite(x)
        each = zip(gaps.tolist(), (tried % 1.0).tolist(), x, normals, strict=True)
        return [Foot(*foot) for foot in each]

    def _slope(self, opposite: Opposite, t: Array) -> Array:
        """f' along the outline."""
        x, dx, _ = self.at(t)
        slope: Array = (opposite(x)[1] * dx).sum(axis=1)
        return slope
