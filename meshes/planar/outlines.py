"""The nodes around bodies of which some are no discs: on their true outlines.

Sizes are those of `sizing`, with the radius of the curvature there, and of what is opposite, for that of a
disc. Nodes stand where derivatives of an outline jump, and where the narrowest gap of a body is.
"""

from __future__ import annotations

import numpy as np

from fsi.meshes.errors import TouchingError
from fsi.meshes.geometry.container import Array, wall_feet
from fsi.meshes.geometry.placed import Foot, Placed
from fsi.meshes.planar.sizing import SHORTEST, Curve, Surfaces
from fsi.meshes.planar.spread import Indices, resolve_all, spread

FEWEST = 8  # elements around a body
AT_JOINT = 1e-6  # of an outline: a narrowest gap so near to a joint is there


def outline_rings(surfaces: Surfaces) -> list[Curve]:
    """The nodes around all bodies. Raises TouchingError where one touches another or a wall."""
    return [_ring(surfaces, i) for i in range(surfaces.bodies)]


def _reach(surfaces: Surfaces, i: int) -> float:
    """The gap up to which body i has smaller elements."""
    resolution = surfaces.resolution
    return float(resolution.cells_per_gap * resolution.on_body(surfaces.radii[i]) / SHORTEST)


def _near(surfaces: Surfaces, i: int) -> list[Placed]:
    """The bodies within that reach of body i."""
    gaps = np.hypot(*(surfaces.centres - surfaces.centres[i]).T) - surfaces.radii - surfaces.radii[i]
    gaps[i] = np.inf
    return [surfaces.placed[j] for j in np.flatnonzero(gaps < _reach(surfaces, i))]


def _ring(surfaces: Surfaces, i: int) -> Curve:
    body, resolution, container = surfaces.placed[i], surfaces.resolution, surfaces.container
    others = _near(surfaces, i)
    start = _start(surfaces, i, others)

    def beside(t: Array, x: Array) -> tuple[Array, Array]:
        """The width of the gap at points x of the outline, and the smaller radius beside it."""
        to_walls = container.distances(x)
        gap, radius = to_walls.min(axis=1, initial=np.inf), body.outline.bend(t)
        if not all(container.plane):
            nearest = to_walls.argmin(axis=1)
            radius = np.minimum(radius, container.bends(x)[np.arange(len(x)), nearest])
        for other in others:
            distance, bend = other.distance_and_bend(x)
            radius = np.where(distance < gap, np.minimum(radius, bend), radius)
            gap = np.minimum(gap, distance)
        return gap, radius

    def size(t: Array, _: Indices) -> Array:
        x, dx, _ddx = body.at(t)
        in_gap = resolution.across(*beside(t, x))
        sizes: Array = np.minimum(in_gap, resolution.on_body(body.outline.bend(t)))
        sizes /= np.hypot(*dx.T)
        return sizes

    breaks = _breaks(body, start)
    t, h, piece = resolve_all(size, np.column_stack([breaks[:-1], breaks[1:]]), resolution.cells_per_circle)
    placed = [
        spread(t[piece == k], h[piece == k], (), FEWEST * length)[:-1]
        for k, length in enumerate(np.diff(breaks))
    ]
    closed = body.outline.poles is None
    t = np.concatenate(placed if closed else [*placed, breaks[-1:]])
    x, normal = body.at(t).x, body.normals(t)
    if not closed:
        x[[0, -1]], normal[[0, -1], 0] = surfaces.on_axis(i), 0.0
    half = 0.5 * resolution.opened(*beside(t, x))
    return Curve(i + 1, x, closed, opening=-half[:, None] * normal, body=body)


def _breaks(body: Placed, start: float | None) -> Array:
    """Where nodes must stand: at a narrow gap, at joints, of a body of revolution at its ends; ascending."""
    fixed = [*body.outline.joints] if start is None else [start, *body.outline.joints]
    first, last = body.outline.poles or (0.0 if start is None else start, np.nan)
    last = first + 1.0 if np.isnan(last) else last
    inner = np.sort([first + (t - first) % 1.0 for t in fixed])
    apart = (inner > first + AT_JOINT) & (inner < last - AT_JOINT)
    apart[1:] &= np.diff(inner) > AT_JOINT
    return np.concatenate([[first], inner[apart], [last]])


def _start(surfaces: Surfaces, i: int, others: list[Placed]) -> float | None:
    """The t of the narrowest gap of body i, of a joint if one is there; None if all gaps are wide."""
    body = surfaces.placed[i]
    feet: list[Foot] = [body.gap_to(other) for other in others]
    feet += wall_feet(body, surfaces.container)
    narrowest = min(feet, key=lambda foot: foot.gap, default=None)
    if narrowest is None or narrowest.gap >= _reach(surfaces, i):
        return None
    if narrowest.gap <= 0.0:
        raise TouchingError("the body at {} touches a body or wall; move it", body.centre)
    t = narrowest.t
    if body.outline.poles is not None:  # of two mirror images the one with r > 0
        t = float(body.nearest(np.abs(narrowest.x[None]) * [1.0, np.sign(narrowest.x[1])])[0])
    away = [abs((t - joint + 0.5) % 1.0 - 0.5) for joint in body.outline.joints]
    if min(away, default=1.0) < AT_JOINT:
        return body.outline.joints[int(np.argmin(away))]
    return t
