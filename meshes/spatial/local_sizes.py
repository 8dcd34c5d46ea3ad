"""The law of sizes where there are many bodies: of each place only those that are near enough to matter.

gmsh asks for sizes some twenty times for each tetrahedron, and evaluates a formula for each body and each
narrow gap every time. Here space is divided into cubes. Within a cube of half diagonal r, whose middle is x,

    h_body + growth b(x) -+ growth r,      h_gap(b_i(x) + b_j(x) -+ 2 r)

bound the law of each body and gap, and only those are looked at there whose lower bound does not exceed the
least of the upper ones. The sizes are the same.
"""

from __future__ import annotations

from math import floor, sqrt

import numpy as np

from fsi.meshes.geometry.container import Array
from fsi.meshes.spatial.sizing import LENGTH, LONGEST, SHORTEST, Spacing

type Key = tuple[int, int, int]


class LocalSizes:
    """Sizes at points, for gmsh's callback."""

    def __init__(self, spacing: Spacing) -> None:
        """Nothing is looked at before it is asked for."""
        domain, resolution = spacing.domain, spacing.resolution
        self._centres, self._radii, self._container = domain.centres, domain.radii, domain.container
        self._on_bodies, self._growth = resolution.on_body(domain.radii), resolution.growth
        self._pairs = spacing.close_pairs()
        self._across = resolution.cells_per_gap
        self._largest = domain.container.largest_element(resolution.cells_per_circle)
        self._width = float(domain.radii.min(initial=domain.container.size()))
        self._near: dict[Key, tuple[list[int], list[int]]] = {}
        bodies = np.column_stack([domain.centres, domain.radii, self._on_bodies])
        self._bodies: list[tuple[float, ...]] = [tuple(row) for row in bodies.tolist()]
        # Of a plane wall the distance is linear: that of the origin, and the normal.
        origin = np.zeros((1, 3))
        distance, normal = domain.container.distances(origin)[0], domain.container.normals(origin)[0]
        self._walls: list[tuple[float, ...]] = [
            tuple(row) for row in np.column_stack([distance, normal]).tolist()
        ]

    def __call__(self, _dim: int, _tag: int, x: float, y: float, z: float, _size: float) -> float:
        """The size at (x, y, z)."""
        key = (floor(x / self._width), floor(y / self._width), floor(z / self._width))
        near = self._near.get(key)
        if near is None:
            near = self._near[key] = self._looked_up(key)
        least = self._largest
        for i in near[0]:
            cx, cy, cz, a, on_body = self._bodies[i]
            size = on_body + self._growth * (sqrt((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2) - a)
            least = min(least, size)
        for k in near[1]:
            pair = self._pairs[k]
            d = self._away(pair.body, x, y, z) + self._away(pair.other, x, y, z)
            along = min(LENGTH * sqrt(pair.smallest * abs(d)), LONGEST * d)
            least = min(least, max(along, SHORTEST * d) / self._across)
        return least

    def _away(self, surface: int, x: float, y: float, z: float) -> float:
        """Distance to a body, or after the bodies to a plane wall."""
        if surface < len(self._bodies):
            cx, cy, cz, a, _ = self._bodies[surface]
            return sqrt((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2) - a
        d, nx, ny, nz = self._walls[surface - len(self._bodies)]
        return d + nx * x + ny * y + nz * z

    def _looked_up(self, key: Key) -> tuple[list[int], list[int]]:
        """The bodies and the pairs that matter in a cube."""
        middle = (np.array(key) + 0.5) * self._width
        r = 0.5 * np.sqrt(3.0) * self._width
        away = np.linalg.norm(self._centres - middle, axis=1) - self._radii
        of_body = self._on_bodies + self._growth * away
        every = np.append(away, self._container.distances(middle[None])[0])
        d = np.array([every[pair.body] + every[pair.other] for pair in self._pairs])
        low, high = self._of_gaps(d - 2.0 * r), self._of_gaps(d + 2.0 * r)
        bounds = (self._largest, of_body.min(initial=np.inf) + self._growth * r, high.min(initial=np.inf))
        least = min(bounds)
        bodies = np.flatnonzero(of_body - self._growth * r <= least)
        return bodies.tolist(), np.flatnonzero(low <= least).tolist()

    def _of_gaps(self, d: Array) -> Array:
        """h_gap of each pair, 0 where d is negative."""
        d = np.maximum(d, 0.0)
        smallest = np.array([pair.smallest for pair in self._pairs])
        along = np.minimum(LENGTH * np.sqrt(smallest * d), LONGEST * d)
        return np.asarray(np.maximum(along, SHORTEST * d) / self._across)
