"""Discs between walls and in cells, and the areas of pores computed from their corners alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.pores.surfaces import CONTAINER, DISC, WALL, BoundingSurfaces
from fsi.pores.topology import Pores


def between(centres: Array, radii: Array, points: Array, normals: Array, periods: Array) -> BoundingSurfaces:
    """Discs and plane walls."""
    n, walls = len(radii), len(points)
    return BoundingSurfaces(
        np.repeat([DISC, WALL], [n, walls]).astype(np.int8),
        np.vstack([centres, points]),
        np.concatenate([radii, np.zeros(walls)]),
        np.vstack([np.zeros((n, 2)), normals]),
        np.zeros(n + walls, bool),
        periods,
    )


def in_cell(centres: Array, radii: Array, vectors: Array) -> BoundingSurfaces:
    return between(centres, radii, np.empty((0, 2)), np.empty((0, 2)), vectors)


def in_channel(centres: Array, radii: Array, length: float, height: float) -> BoundingSurfaces:
    points, normals = np.array([[0.0, 0.0], [0.0, height]]), np.array([[0.0, 1.0], [0.0, -1.0]])
    return between(centres, radii, points, normals, np.array([[length, 0.0]]))


def in_box(centres: Array, radii: Array, length: float, height: float) -> BoundingSurfaces:
    points = np.array([[0.0, 0.0], [length, 0.0], [0.0, 0.0], [0.0, height]])
    normals = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    return between(centres, radii, points, normals, np.empty((0, 2)))


def in_square(centres: Array, radii: Array, walls: int) -> BoundingSurfaces:
    """Of side 1 with 0, 2 or 4 walls."""
    if walls == 4:
        return in_box(centres, radii, 1.0, 1.0)
    return in_channel(centres, radii, 1.0, 1.0) if walls else in_cell(centres, radii, np.eye(2))


def in_container(centres: Array, radii: Array, radius: float) -> BoundingSurfaces:
    n = len(radii)
    return BoundingSurfaces(
        np.append(np.full(n, DISC), CONTAINER).astype(np.int8),
        np.vstack([centres, [[0.0, 0.0]]]),
        np.append(radii, radius),
        np.zeros((n + 1, 2)),
        np.zeros(n + 1, bool),
        np.empty((0, 2)),
    )


def scattered(seed: int, n: int, ratio: float, walls: int = 0) -> tuple[Array, Array]:
    """Up to n discs without overlap in the unit square, every other one smaller, at most 45 % of the area.

    The square is periodic but between walls: 0, 2 (below and above) or 4.
    """
    shut = np.array([walls == 4, walls > 0])
    rng = np.random.default_rng(seed)
    radii = np.where(np.arange(n) % 2, ratio, 1.0)
    radii *= np.sqrt(rng.uniform(0.01, 0.45) / np.pi / np.sum(radii**2))
    centres = np.empty((0, 2))
    kept: list[int] = []
    for k in np.argsort(-radii, kind="stable"):
        low = np.where(shut, radii[k] + 1e-3, 0.0)
        for x in rng.uniform(low, 1.0 - low, (200, 2)):
            away = centres - x
            away -= np.where(shut, 0.0, np.round(away))
            if np.all(np.hypot(*away.T) > 1.001 * (radii[kept] + radii[k])) and 2.0 * radii[k] < 0.99:
                centres, kept = np.vstack([centres, x]), [*kept, int(k)]
                break
    return centres, radii[kept]


def feet(pores: Pores) -> tuple[Array, Array]:
    """Of side k of each pore the ends of its neck, on corners k + 1 and k + 2, (E, 3, 2) both."""
    surfaces = pores.surfaces
    P = np.zeros((2, 2))
    P[: len(surfaces.periods)] = surfaces.periods
    x = surfaces.centre[pores.vertices] + pores.image @ P
    ends = []
    for one, other in ((1, 2), (2, 1)):
        a, b = np.roll(pores.vertices, -one, axis=1), np.roll(pores.vertices, -other, axis=1)
        xa, xb = np.roll(x, -one, axis=1), np.roll(x, -other, axis=1)
        n, r = surfaces.normal, surfaces.radius[..., None]
        to_wall = -n[b]
        outwards = (xa - xb) / np.maximum(np.linalg.norm(xa - xb, axis=-1, keepdims=True), 1e-300)
        kind_a, kind_b = surfaces.kind[a][..., None], surfaces.kind[b][..., None]
        direction = np.where(kind_b == WALL, to_wall, np.where(kind_b == CONTAINER, outwards, -outwards))
        on_disc = xa + r[a] * direction
        on_wall = xb - ((xb - xa) * n[a]).sum(axis=-1, keepdims=True) * n[a]
        on_container = xa - r[a] * outwards
        ends.append(np.where(kind_a == WALL, on_wall, np.where(kind_a == CONTAINER, on_container, on_disc)))
    return ends[0], ends[1]


def corner_point(surfaces: BoundingSurfaces, v: int, w: int) -> Array:
    """Where two walls meet."""
    n = surfaces.normal[[v, w]]
    return np.linalg.solve(n, (n * surfaces.centre[[v, w]]).sum(axis=1))


def areas(pores: Pores) -> Array:
    """Of each pore: that of the polygon of feet, less the segments of discs, with that of a container."""
    surfaces = pores.surfaces
    first, last = feet(pores)
    total = np.zeros(len(pores))
    for t, v in enumerate(pores.vertices):
        # Anticlockwise: along side 2 from corner 0 to 1, over corner 1, along side 0, over corner 2, ...
        polygon, segments = [], 0.0
        for k in range(3):
            side = (k + 2) % 3
            if pores.sides[t, side] >= 0:
                polygon += [first[t, side], last[t, side]]
            else:
                polygon += [corner_point(surfaces, v[k], v[(k + 1) % 3])]
        for k in range(3):
            if surfaces.kind[v[k]] == WALL:
                continue
            chord = np.linalg.norm(last[t, (k + 1) % 3] - first[t, (k + 2) % 3])
            half = np.arcsin(np.clip(0.5 * chord / surfaces.radius[v[k]], -1.0, 1.0))
            segment = surfaces.radius[v[k]] ** 2 * (half - np.sin(half) * np.cos(half))
            segments += segment if surfaces.kind[v[k]] == CONTAINER else -segment
        x, y = np.array(polygon).T
        total[t] = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) + segments
    return total


def area_inside(surfaces: BoundingSurfaces) -> float:
    """Of fluid and discs together: in a cell, channel, round container or upright box."""
    V, bounds = surfaces.periods, slice(surfaces.discs, None)
    if len(V) == 2:
        return float(abs(np.linalg.det(V)))
    if surfaces.kind[-1] == CONTAINER:
        return float(np.pi * surfaces.radius[-1] ** 2)
    width, height = np.ptp(surfaces.centre[bounds], axis=0)
    return float(height * (np.hypot(*V[0]) if len(V) else width))


def neighbours_of_necks(pores: Pores, names: NDArray[np.int64]) -> set[tuple[int, int, int]]:
    """Each neck by the old names of its bodies and its length to 9 digits."""
    pairs = np.sort(names[pores.necks], axis=1)
    lengths = np.round(pores.neck_gap * 1e9).astype(np.int64)
    return {(int(i), int(j), int(d)) for (i, j), d in zip(pairs, lengths, strict=True)}
