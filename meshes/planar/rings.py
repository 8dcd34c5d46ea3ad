"""The nodes around bodies: on whole circles, on half ones beside an axis, and on arcs between links of a cut.

Their sizes are those of `sizing`, from what is near each body: farther surfaces do not change them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices, parted
from fsi.meshes.errors import TouchingError
from fsi.meshes.planar.facing import NARROW, FacedGap, on_circle
from fsi.meshes.planar.sizing import Curve, Surfaces
from fsi.meshes.planar.spread import resolve_all, spread_all
from fsi.meshes.resolution import SHORTEST


def rings(surfaces: Surfaces, bodies: Sequence[int]) -> list[Curve]:
    """The nodes around bodies, each from where its gap is narrowest, so that a node stands there.

    Raises MeshError where a body touches another or a wall.
    """
    near = Neighbourhoods.of(surfaces, bodies)
    turns = near.narrowest[:, None] + np.array([0.0, 2.0 * np.pi])
    chains = zip(bodies, _on_arcs(surfaces, near, turns), strict=True)
    return [Curve(i + 1, x[:-1], True, surfaces.centres[i], opening[:-1]) for i, (x, opening) in chains]


def half_ring(surfaces: Surfaces, i: int) -> Curve:
    """The nodes from pole to pole of body i on the axis."""
    (curve,) = arcs(surfaces, [i], np.array([[-0.5, 0.5]]) * np.pi)
    curve.nodes[[0, -1]] = surfaces.on_axis(i)
    return curve


def arcs(surfaces: Surfaces, bodies: Sequence[int], angles: Array) -> list[Curve]:
    """The nodes on bodies between two angles each, start < end, (n, 2)."""
    chains = zip(bodies, _on_arcs(surfaces, Neighbourhoods.of(surfaces, bodies), angles), strict=True)
    return [Curve(i + 1, x, False, surfaces.centres[i], opening) for i, (x, opening) in chains]


@dataclass(frozen=True, slots=True)
class Neighbourhoods:
    """What is so near n bodies that they have smaller elements there.

    Attributes:
        bodies: which.
        centres: of the bodies near each, (n, most, 2).
        radii: of these, (n, most); -inf where there are fewer, as if they were infinitely far.
        walls: which walls are near, (n, walls).
        smallest: of all radii, the own one included, (n,).
        narrowest: the angle at which the narrowest gap is, (n,).
        facing: of each the gaps so narrow that nodes face each other in them, and their angles.
    """

    bodies: list[int]
    centres: Array
    radii: Array
    walls: NDArray[np.bool_]
    smallest: Array
    narrowest: Array
    facing: list[list[tuple[FacedGap, float]]]

    @staticmethod
    def of(surfaces: Surfaces, bodies: Sequence[int]) -> Neighbourhoods:
        """Of some bodies. Raises MeshError where one touches another or a wall.

        All at once: one by one they took a tenth of the time of a mesh of 1000 discs.
        """
        container, chosen = surfaces.container, list(bodies)
        own, radius = surfaces.centres[chosen], surfaces.radii[chosen]
        # Where h_gap reaches h_body: farther surfaces do not change the size of the elements.
        reach = surfaces.resolution.cells_per_gap * surfaces.resolution.on_body(radius) / SHORTEST
        of, other = _near(surfaces, chosen, reach)
        column = np.arange(len(of)) - np.searchsorted(of, of)
        most = int(column.max(initial=-1)) + 1
        centres, radii = np.zeros((len(own), most, 2)), np.full((len(own), most), -np.inf)
        centres[of, column], radii[of, column] = surfaces.centres[other], surfaces.radii[other]
        off = centres - own[:, None]
        to_walls = container.distances(own) - radius[:, None]
        walls = to_walls < reach[:, None]
        gaps = np.hypot(off[..., 0], off[..., 1]) - radii - radius[:, None]
        gaps = np.concatenate([gaps, np.where(walls, to_walls, np.inf)], axis=1)
        touching = np.flatnonzero(gaps.min(axis=1, initial=np.inf) <= 0.0)
        if len(touching):
            raise TouchingError("the disc at {} touches a disc or wall; move it", own[touching[0]])
        # 0 - n, not -n: minus zero would turn an angle of pi into -pi.
        towards = np.concatenate([off, 0.0 - container.normals(own)], axis=1)
        angles = np.arctan2(towards[..., 1], towards[..., 0])
        narrowest = np.zeros(len(own))
        some = np.flatnonzero(np.isfinite(gaps).any(axis=1))
        if len(some):
            narrowest[some] = angles[some, np.argmin(gaps[some], axis=1)]
        beside = np.where(np.isfinite(radii), np.minimum(radii, radius[:, None]), np.inf)
        smallest = np.minimum(radius, beside.min(axis=1, initial=np.inf))
        facing = _facing(surfaces, chosen, radii, gaps, angles)
        return Neighbourhoods(chosen, centres, radii, walls, smallest, narrowest, facing)


def _facing(
    surfaces: Surfaces, bodies: list[int], radii: Array, gaps: Array, angles: Array
) -> list[list[tuple[FacedGap, float]]]:
    """The narrow gaps of each body; radii of the others near it, gaps and angles of these and of walls."""
    own, most = surfaces.radii[bodies], radii.shape[1]
    beside = np.tile(own[:, None], gaps.shape[1])
    beside[:, :most] = np.where(np.isfinite(radii), np.minimum(radii, own[:, None]), own[:, None])
    facing: list[list[tuple[FacedGap, float]]] = [[] for _ in bodies]
    for k, j in np.argwhere(gaps < NARROW * beside).tolist():
        bend = 1.0 / float(radii[k, j]) if j < most else surfaces.curvature(j - most)
        gap = FacedGap(float(gaps[k, j]), float(beside[k, j]), 1.0 / float(own[k]) + bend)
        facing[k].append((gap, float(angles[k, j])))
    return facing


def _near(surfaces: Surfaces, bodies: list[int], reach: Array) -> tuple[Indices, Indices]:
    """Which of these bodies and which others or images have gaps below the reach; pairs, by the former."""
    own, radius = surfaces.centres[bodies], surfaces.radii[bodies]
    near = surfaces.nearby.within(own, radius + surfaces.radii.max() + reach) if bodies else []
    of = np.repeat(np.arange(len(bodies)), [len(others) for others in near])
    other = np.array([other for others in near for other in others], dtype=np.int64)
    off = surfaces.centres[other] - own[of]
    gaps = np.hypot(off[:, 0], off[:, 1]) - surfaces.radii[other] - radius[of]
    chosen = (gaps < reach[of]) & (other != np.array(bodies, dtype=np.int64)[of])
    return of[chosen], other[chosen]


def _fixed(
    facing: Sequence[tuple[FacedGap, float]], radius: float, ends: Array, cells: float
) -> Iterator[Array]:
    """The places of nodes that face others in narrow gaps, along an arc between two angles."""
    for gap, angle in facing:
        first, last = (ends - angle) / (2.0 * np.pi)
        for turn in range(floor(first), ceil(last) + 1):
            yield on_circle(angle + 2.0 * np.pi * turn, radius, gap.places(cells))


def _on_arcs(surfaces: Surfaces, near: Neighbourhoods, angles: Array) -> list[tuple[Array, Array]]:
    """Nodes on bodies between two angles each, both included, on a whole circle at least 8; their openings.

    All are placed together: one by one they took a fifth of the time of a mesh of 200 discs.
    """
    if not near.bodies:
        return []
    resolution = surfaces.resolution
    centres, radii = surfaces.centres[near.bodies], surfaces.radii[near.bodies]
    h_body, smallest = resolution.on_body(radii), near.smallest

    def place(s: Array, k: Indices) -> Array:
        turn, a = s / radii[k], radii[k][:, None]
        x: Array = centres[k] + a * np.column_stack([np.cos(turn), np.sin(turn)])
        return x

    def distance(x: Array, k: Indices) -> Array:
        away = x[:, None] - near.centres[k]
        to_near = np.hypot(away[..., 0], away[..., 1]) - near.radii[k]
        to_walls = np.where(near.walls[k], surfaces.container.distances(x), np.inf)
        nearest: Array = np.column_stack([to_near, to_walls]).min(axis=1, initial=np.inf)
        return nearest

    def size(s: Array, k: Indices) -> Array:
        of_gap: Array = np.minimum(resolution.across(distance(place(s, k), k), smallest[k]), h_body[k])
        return of_gap

    s, h, curve = resolve_all(size, angles * radii[:, None], resolution.cells_per_circle)
    fixed = [
        list(_fixed(facing, float(radius), ends, resolution.cells_per_gap))
        for facing, radius, ends in zip(near.facing, radii, angles, strict=True)
    ]
    placed = spread_all(s, h, curve, fixed, 8.0 * (angles[:, 1] - angles[:, 0]) / (2.0 * np.pi))
    of = np.repeat(np.arange(len(placed)), [len(places) for places in placed])
    x = place(np.concatenate(placed), of)
    half = 0.5 * resolution.opened(distance(x, of), smallest[of])
    opening = half[:, None] * (centres[of] - x) / radii[of][:, None]
    after = np.cumsum([len(places) for places in placed])[:-1].tolist()
    return list(zip(parted(x, after), parted(opening, after), strict=True))
