"""The nodes around bodies: on whole circles, on half ones beside an axis, and on arcs between links of a cut.

Their sizes are those of `sizing`, from what is near each body: farther surfaces do not change them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

from fsi.meshes.errors import TouchingError
from fsi.meshes.geometry.container import Array
from fsi.meshes.planar.facing import NARROW, FacedGap, on_circle
from fsi.meshes.planar.sizing import SHORTEST, Curve, Surfaces
from fsi.meshes.planar.spread import Indices, resolve_all, spread


def rings(surfaces: Surfaces, bodies: Sequence[int]) -> list[Curve]:
    """The nodes around bodies, each from where its gap is narrowest, so that a node stands there.

    Raises MeshError where a body touches another or a wall.
    """
    near = _neighbourhoods(surfaces, bodies)
    turns = np.array([(body.narrowest, body.narrowest + 2.0 * np.pi) for body in near]).reshape(-1, 2)
    chains = zip(bodies, _on_arcs(surfaces, near, turns), strict=True)
    return [Curve(i + 1, x[:-1], True, surfaces.centres[i], opening[:-1]) for i, (x, opening) in chains]


def half_ring(surfaces: Surfaces, i: int) -> Curve:
    """The nodes from pole to pole of body i on the axis."""
    (curve,) = arcs(surfaces, [i], np.array([[-0.5, 0.5]]) * np.pi)
    curve.nodes[[0, -1]] = surfaces.on_axis(i)
    return curve


def arcs(surfaces: Surfaces, bodies: Sequence[int], angles: Array) -> list[Curve]:
    """The nodes on bodies between two angles each, start < end, (n, 2)."""
    near = _neighbourhoods(surfaces, bodies)
    chains = zip(bodies, _on_arcs(surfaces, near, angles), strict=True)
    return [Curve(i + 1, x, False, surfaces.centres[i], opening) for i, (x, opening) in chains]


@dataclass(frozen=True, slots=True)
class Neighbourhood:
    """What is so near body i that it has smaller elements there.

    Attributes:
        i: the body.
        centres: of the bodies near it, (n, 2).
        radii: of these, (n,).
        walls: which walls are near, (walls,).
        smallest: of all radii, its own included.
        narrowest: the angle at which its narrowest gap is.
        facing: gaps so narrow that nodes face each other in them, and the angles at which they are.
    """

    i: int
    centres: Array
    radii: Array
    walls: NDArray[np.bool_]
    smallest: float
    narrowest: float
    facing: list[tuple[FacedGap, float]]


def _neighbourhoods(surfaces: Surfaces, bodies: Sequence[int]) -> list[Neighbourhood]:
    """What is near each of these bodies. Raises MeshError where one touches another or a wall."""
    if len(bodies) == 0:
        return []
    container, chosen = surfaces.container, list(bodies)
    centres, radii = surfaces.centres[chosen], surfaces.radii[chosen]
    # Where h_gap reaches h_body: farther surfaces do not change the size of the elements.
    reach = surfaces.resolution.cells_per_gap * surfaces.resolution.on_body(radii) / SHORTEST
    near = surfaces.nearby.within(centres, radii + surfaces.radii.max() + reach)
    walls = zip(container.distances(centres) - radii[:, None], container.normals(centres), strict=True)
    each = zip(bodies, near, reach.tolist(), walls, strict=True)
    return [_neighbourhood(surfaces, *about) for about in each]


def _neighbourhood(
    surfaces: Surfaces, i: int, near: list[int], reach: float, to_walls: tuple[Array, Array]
) -> Neighbourhood:
    """What lies within a reach of body i, of the bodies near it and the walls, by their gaps and normals."""
    centre, radius, (wall_gaps, normals) = surfaces.centres[i], float(surfaces.radii[i]), to_walls
    others = np.array([other for other in near if other != i], dtype=np.intp)
    off = surfaces.centres[others] - centre
    gaps = np.hypot(off[:, 0], off[:, 1]) - surfaces.radii[others] - radius
    is_near, walls = gaps < reach, wall_gaps < reach
    centres, radii = surfaces.centres[others[is_near]], surfaces.radii[others[is_near]]
    gaps = np.concatenate([gaps[is_near], wall_gaps[walls]])
    if gaps.min(initial=np.inf) <= 0.0:
        raise TouchingError("the disc at {} touches a disc or wall; move it", centre)
    # 0 - n, not -n: minus zero would turn an angle of pi into -pi.
    towards = np.concatenate([off[is_near], (0.0 - normals)[walls]])
    angles = np.arctan2(towards[:, 1], towards[:, 0])
    narrowest = float(angles[np.argmin(gaps)]) if len(gaps) else 0.0
    smallest = min(radius, float(radii.min(initial=np.inf)))
    curvatures = [*(1.0 / radii), *(surfaces.curvature(wall) for wall in np.flatnonzero(walls).tolist())]
    beside = np.append(np.minimum(radii, radius), np.full(walls.sum(), radius))
    facing = [
        (FacedGap(float(gaps[k]), float(beside[k]), 1.0 / radius + float(curvatures[k])), float(angles[k]))
        for k in np.flatnonzero(gaps < NARROW * beside)
    ]
    return Neighbourhood(i, centres, radii, walls, smallest, narrowest, facing)


def _fixed(body: Neighbourhood, radius: float, start: float, end: float, cells: float) -> Iterator[Array]:
    """The places of nodes that face others in narrow gaps, along an arc between two angles."""
    for gap, angle in body.facing:
        for turn in range(floor((start - angle) / (2.0 * np.pi)), ceil((end - angle) / (2.0 * np.pi)) + 1):
            yield on_circle(angle + 2.0 * np.pi * turn, radius, gap.places(cells))


def _on_arcs(surfaces: Surfaces, near: Sequence[Neighbourhood], angles: Array) -> list[tuple[Array, Array]]:
    """Nodes on bodies between two angles each, both included, on a whole circle at least 8; their openings.

    All are placed together: one by one they took a fifth of the time of a mesh of 200 discs.
    """
    if not near:
        return []
    resolution, bodies = surfaces.resolution, [body.i for body in near]
    centres, radii = surfaces.centres[bodies], surfaces.radii[bodies]
    h_body = resolution.on_body(radii)
    smallest, walls = np.array([body.smallest for body in near]), np.array([body.walls for body in near])
    most = max(len(body.radii) for body in near)
    # Where there are fewer, the others are infinitely far.
    others, sizes = np.zeros((len(near), most, 2)), np.full((len(near), most), -np.inf)
    for k, body in enumerate(near):
        others[k, : len(body.radii)], sizes[k, : len(body.radii)] = body.centres, body.radii

    def place(s: Array, k: Indices) -> Array:
        turn, a = s / radii[k], radii[k][:, None]
        x: Array = centres[k] + a * np.column_stack([np.cos(turn), np.sin(turn)])
        return x

    def distance(x: Array, k: Indices) -> Array:
        away = x[:, None] - others[k]
        to_near = np.hypot(away[..., 0], away[..., 1]) - sizes[k]
        to_walls = np.where(walls[k], surfaces.container.distances(x), np.inf)
        nearest: Array = np.column_stack([to_near, to_walls]).min(axis=1, initial=np.inf)
        return nearest

    def size(s: Array, k: Indices) -> Array:
        of_gap: Array = np.minimum(resolution.across(distance(place(s, k), k), smallest[k]), h_body[k])
        return of_gap

    s, h, curve = resolve_all(size, angles * radii[:, None], resolution.cells_per_circle)
    first = np.searchsorted(curve, np.arange(len(near) + 1))
    placed = []
    for k, (start, end) in enumerate(angles):
        part = slice(first[k], first[k + 1])
        fixed = _fixed(near[k], float(radii[k]), start, end, resolution.cells_per_gap)
        placed.append(spread(s[part], h[part], fixed, 8.0 * (end - start) / (2.0 * np.pi)))
    of = np.repeat(np.arange(len(near)), [len(places) for places in placed])
    x = place(np.concatenate(placed), of)
    half = 0.5 * resolution.opened(distance(x, of), smallest[of])
    opening = half[:, None] * (centres[of] - x) / radii[of][:, None]
    after = np.cumsum([len(places) for places in placed])[:-1]
    return list(zip(np.split(x, after), np.split(opening, after), strict=True))
