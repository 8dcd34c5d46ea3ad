"""The law of sizes where there are many bodies: of each place only those that are near enough to matter.

gmsh asks for sizes some twenty times for each tetrahedron, and evaluates a formula for each body and each
narrow gap every time. Here space is divided into cubes. Within a cube of half diagonal r, whose middle is x,

    h_body + growth b(x) -+ growth r,      h_gap(b_i(x) + b_j(x) -+ 2 r)

bound the law of each body and gap, and only those are looked at there whose lower bound does not exceed the
least of the upper ones. The sizes are the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, sqrt

import numpy as np

from fsi.arrays import Array, Indices
from fsi.meshes.spatial.sizing import LENGTH, SHORTEST, Spacing

type Key = tuple[int, int, int]

WIDTH = 0.5  # of cubes, over the smallest radius


@dataclass(frozen=True, slots=True)
class _Near:
    """What matters in a cube.

    Attributes:
        bodies: centre, radius and size on it of each body, also of those that only pairs are of.
        walls: of each plane wall that a pair is of, the distance of the origin, and the normal.
        pairs: each with its surfaces, numbers among bodies and then walls, the smaller radius, and the
            longest that cells are over the width.
    """

    bodies: list[tuple[float, float, float, float, float]]
    walls: list[tuple[float, float, float, float]]
    pairs: list[tuple[int, int, float, float]]


class LocalSizes:
    """Sizes at points, for gmsh's callback."""

    def __init__(self, spacing: Spacing) -> None:
        """Nothing is looked at before it is asked for."""
        domain, resolution = spacing.domain, spacing.resolution
        self._centres, self._radii, self._container = domain.centres, domain.radii, domain.container
        self._on_bodies, self._growth = resolution.on_body(domain.radii), resolution.growth
        self._pairs = spacing.close_pairs()
        self._surfaces = np.array([(p.body, p.other) for p in self._pairs], dtype=np.int64).reshape(-1, 2)
        self._smallest = np.array([pair.smallest for pair in self._pairs])
        self._longest = np.array([pair.longest for pair in self._pairs])
        self._across = resolution.cells_per_gap
        self._largest = spacing.largest
        self._width = WIDTH * float(domain.radii.min(initial=domain.container.size()))
        self._near: dict[Key, _Near] = {}
        # Of a plane wall the distance is linear.
        origin = np.zeros((1, 3))
        distance, normal = domain.container.distances(origin)[0], domain.container.normals(origin)[0]
        self._walls = np.column_stack([distance, normal])

    def __call__(self, _dim: int, _tag: int, x: float, y: float, z: float, _size: float) -> float:
        """The size at (x, y, z)."""
        key = (floor(x / self._width), floor(y / self._width), floor(z / self._width))
        near = self._near.get(key)
        if near is None:
            near = self._near[key] = self._looked_up(key)
        least, growth, away = self._largest, self._growth, list[float]()
        for cx, cy, cz, a, on_body in near.bodies:
            dx, dy, dz = x - cx, y - cy, z - cz
            d = sqrt(dx * dx + dy * dy + dz * dz) - a
            away.append(d)
            size = on_body + growth * d
            if size < least:  # min() takes three times as long
                least = size
        for d, nx, ny, nz in near.walls:
            away.append(d + nx * x + ny * y + nz * z)
        for i, j, smallest, longest in near.pairs:
            d = away[i] + away[j]
            along = min(LENGTH * sqrt(smallest * abs(d)), longest * d)
            size = max(along, SHORTEST * d) / self._across
            if size < least:
                least = size
        return least

    def _looked_up(self, key: Key) -> _Near:
        """The bodies and the pairs that matter in a cube."""
        middle = (np.array(key) + 0.5) * self._width
        r = 0.5 * np.sqrt(3.0) * self._width
        away = np.linalg.norm(self._centres - middle, axis=1) - self._radii
        of_body = self._on_bodies + self._growth * away
        every = np.append(away, self._container.distances(middle[None])[0])
        d = every[self._surfaces].sum(axis=1)
        low, high = self._of_gaps(d - 2.0 * r), self._of_gaps(d + 2.0 * r)
        bounds = (self._largest, of_body.min(initial=np.inf) + self._growth * r, high.min(initial=np.inf))
        least = min(bounds)
        return self._listed(np.flatnonzero(of_body - self._growth * r <= least), np.flatnonzero(low <= least))

    def _listed(self, bodies: Indices, pairs: Indices) -> _Near:
        """These bodies and pairs, and the surfaces of the pairs."""
        every = np.union1d(bodies, self._surfaces[pairs])
        count = len(self._radii)
        bodies, walls = every[every < count], every[every >= count] - count
        of_bodies = np.column_stack([self._centres, self._radii, self._on_bodies])[bodies]
        chosen = (np.searchsorted(every, self._surfaces[pairs]), self._smallest[pairs], self._longest[pairs])
        return _Near(
            [tuple(row) for row in of_bodies.tolist()],
            [tuple(row) for row in self._walls[walls].tolist()],
            [(*ij, s, l) for ij, s, l in zip(*(each.tolist() for each in chosen), strict=True)],  # noqa: E741
        )

    def _of_gaps(self, d: Array) -> Array:
        """h_gap of each pair, 0 where d is negative."""
        d = np.maximum(d, 0.0)
        along = np.minimum(LENGTH * np.sqrt(self._smallest * d), self._longest * d)
        return np.asarray(np.maximum(along, SHORTEST * d) / self._across)
