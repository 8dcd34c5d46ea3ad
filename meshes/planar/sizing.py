"""Where the nodes on the bodies go: element sizes from the gaps.

The element size on a body is

    h(x) = min(h_gap(gap(x)), h_body),   h_body = 2 pi a / cells_per_circle,

where `gap(x)` is the distance from the surface point x to the nearest other surface, and on a wall

    h(x) = min(h_gap(d(x)), max(h_body, growth d(x)), side / 4),

where `d(x)` is the distance to the nearest body. The flow in a narrow gap is a polynomial across it and
varies along it over the lubrication length sqrt(a gap), so that is what a cell must resolve:

    h_gap(d) = 0.11 sqrt(a d) / cells_per_gap,   but within [0.3 d, 4 d] / cells_per_gap.

With cells_per_gap = 1 that is one cell across a gap of 0.012 a, three across gaps above 0.13 a; in narrower
gaps cells are longer than wide, and the error of the force still falls with the gap.
Nodes equidistribute `int ds / h`. gmsh then extends the sizes of the boundary into the fluid, if its interior
shall be graded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.containers import Array, Container
from fsi.meshes.geometry.lattice import NO_LATTICE, Lattice
from fsi.meshes.planar.nodes_on_curves import Indices, equidistribute, resolve_all

LENGTH, SHORTEST, LONGEST = 0.11, 0.3, 4.0
NEIGHBOURS = 16


@dataclass(frozen=True, slots=True)
class Resolution:
    """How fine a mesh is.

    cells_per_gap: elements across a gap of 0.012 radii; cells_per_circle: elements around an isolated body;
    growth: element size over the distance to the nearest body, far from all bodies; interior: "graded",
    where sizes in the fluid go over smoothly into those on the boundary, or in the plane "sparse", where
    those hold on the boundary alone. In a suspension of area fraction 0.4 sparse meshes have a fifth fewer
    unknowns for an error of 5e-4 of the apparent viscosity.
    """

    cells_per_gap: float = 1.0
    cells_per_circle: int = 48
    growth: float = 0.2
    interior: Literal["graded", "sparse"] = "graded"


@dataclass(frozen=True, slots=True)
class Curve:
    """One piece of the boundary as a chain of nodes.

    tag: facet tag; nodes: shape (n, 2), in order; for a closed curve the first node is not repeated;
    centre: of the circle that the curve follows, None for a straight piece.
    """

    tag: int
    nodes: Array
    closed: bool
    centre: Array | None


@dataclass(frozen=True, slots=True)
class Surfaces:
    """The bodies and the container, and how far a point is from them.

    centres (n, 2), radii (n,): of the bodies, and after them of their images in a periodic container; tree:
    over the centres; bodies: N; lattice: of the container's periods.
    """

    container: Container
    centres: Array
    radii: Array
    tree: cKDTree
    bodies: int
    lattice: Lattice = NO_LATTICE

    def to_bodies(self, x: Array) -> Array:
        """Distance of each point (n, 2) to the nearest body, shape (n,); infinite without bodies."""
        if len(self.radii) == 0:
            return np.full(len(x), np.inf)
        x = self.lattice.wrapped(x)
        k = min(len(self.radii), NEIGHBOURS)
        away, body = self.tree.query(x, k=[*range(1, k + 1)])
        nearest: Array = (away - self.radii[body]).min(axis=1)
        # A body beyond the k nearest centres can only be nearer if it is larger.
        unsure = (away[:, -1] - self.radii.max() < nearest) & (k < len(self.radii))
        for point in np.flatnonzero(unsure):
            nearest[point] = (np.hypot(*(x[point] - self.centres).T) - self.radii).min()
        return nearest


def bodies(surfaces: Surfaces, resolution: Resolution) -> list[Curve]:
    """The curve around each body, with tags 1, ..., N: closed, or with an axis from pole to pole.

    Raises:
        MeshError: a body touches another or a wall.
    """
    if not surfaces.container.axisymmetric:
        return around(surfaces, resolution, range(surfaces.bodies))
    return [half_around(surfaces, resolution, i) for i in range(surfaces.bodies)]


def around(surfaces: Surfaces, resolution: Resolution, chosen: Sequence[int]) -> list[Curve]:
    """The nodes around bodies, each from where its gap is narrowest, so that a node stands there."""
    near = [_near(surfaces, resolution, i) for i in chosen]
    turns = np.array([(body.narrowest, body.narrowest + 2.0 * np.pi) for body in near]).reshape(-1, 2)
    rings = _on_arcs(surfaces, resolution, near, turns)
    return [
        Curve(i + 1, nodes[:-1], closed=True, centre=surfaces.centres[i])
        for i, nodes in zip(chosen, rings, strict=True)
    ]


def half_around(surfaces: Surfaces, resolution: Resolution, i: int) -> Curve:
    """The nodes from pole to pole of body i on the axis."""
    (curve,) = arcs(surfaces, resolution, [i], np.array([[-0.5, 0.5]]) * np.pi)
    centre, radius = surfaces.centres[i], surfaces.radii[i]
    curve.nodes[[0, -1]] = [[0.0, centre[1] - radius], [0.0, centre[1] + radius]]
    return curve


def arcs(surfaces: Surfaces, resolution: Resolution, chosen: Sequence[int], angles: Array) -> list[Curve]:
    """The nodes on bodies between two angles each, start < end, (n, 2)."""
    near = [_near(surfaces, resolution, i) for i in chosen]
    pieces = _on_arcs(surfaces, resolution, near, angles)
    return [
        Curve(i + 1, nodes, closed=False, centre=surfaces.centres[i])
        for i, nodes in zip(chosen, pieces, strict=True)
    ]


@dataclass(frozen=True, slots=True)
class Near:
    """What is so near body i that it has smaller elements there.

    centres, radii: of the bodies, (n, 2), (n,); walls: which, bool; smallest: of all radii, its own
    included; narrowest: the angle at which its gap is.
    """

    i: int
    centres: Array
    radii: Array
    walls: NDArray[np.bool_]
    smallest: float
    narrowest: float


def _near(surfaces: Surfaces, resolution: Resolution, i: int) -> Near:
    """What is near body i. Raises MeshError where it touches."""
    centre, radius, radii = surfaces.centres[i], float(surfaces.radii[i]), surfaces.radii
    reach = resolution.cells_per_gap * 2.0 * np.pi * radius / resolution.cells_per_circle / SHORTEST
    near = np.asarray(surfaces.tree.query_ball_point(centre, radius + radii.max() + reach), dtype=np.intp)
    gaps = np.hypot(*(surfaces.centres[near] - centre).T) - radii[near] - radius
    near, gaps = near[(near != i) & (gaps < reach)], gaps[(near != i) & (gaps < reach)]
    wall_gaps = surfaces.container.distances(centre[None])[0] - radius
    walls = wall_gaps < reach
    gaps = np.concatenate([gaps, wall_gaps[walls]])
    if gaps.min(initial=np.inf) <= 0.0:
        raise MeshError(f"the disc at ({centre[0]:.6g}, {centre[1]:.6g}) touches a disc or wall; move it")
    towards = np.concatenate([surfaces.centres[near] - centre, _to_walls(surfaces.container, centre)[walls]])
    narrowest = float(np.arctan2(*towards[np.argmin(gaps), ::-1])) if len(gaps) else 0.0
    smallest = min(radius, float(radii[near].min(initial=np.inf)))
    return Near(i, surfaces.centres[near], radii[near], walls, smallest, narrowest)


def _on_arcs(surfaces: Surfaces, resolution: Resolution, near: Sequence[Near], angles: Array) -> list[Array]:
    """Nodes on bodies between two angles each, (n, 2), both included; on a whole circle at least 8.

    All are placed together: one by one they took a fifth of the time of a mesh of 200 discs.
    """
    if not near:
        return []
    own = [body.i for body in near]
    centres, radii = surfaces.centres[own], surfaces.radii[own]
    h_body = 2.0 * np.pi * radii / resolution.cells_per_circle
    smallest, walls = np.array([body.smallest for body in near]), np.array([body.walls for body in near])
    most = max(len(body.radii) for body in near)
    # Where there are fewer, the others are infinitely far.
    others, sizes = np.zeros((len(near), most, 2)), np.full((len(near), most), -np.inf)
    for k, body in enumerate(near):
        others[k, : len(body.radii)], sizes[k, : len(body.radii)] = body.centres, body.radii

    def at(s: Array, k: Indices) -> Array:
        turn, a = s / radii[k], radii[k][:, None]
        x: Array = centres[k] + a * np.column_stack([np.cos(turn), np.sin(turn)])
        return x

    def size(s: Array, k: Indices) -> Array:
        x = at(s, k)
        away = x[:, None] - others[k]
        to_near = np.hypot(away[..., 0], away[..., 1]) - sizes[k]
        to_walls = np.where(walls[k], surfaces.container.distances(x), np.inf)
        distance = np.column_stack([to_near, to_walls]).min(axis=1, initial=np.inf)
        of_gap: Array = np.minimum(across(distance, smallest[k], resolution), h_body[k])
        return of_gap

    found = []
    ends = angles * radii[:, None]
    s, h, curve = resolve_all(size, ends, resolution.cells_per_circle)
    first = np.searchsorted(curve, np.arange(len(near) + 1))
    for k, (start, end) in enumerate(angles):
        part = slice(first[k], first[k + 1])
        least = max(1, round(8 * (end - start) / (2.0 * np.pi)))
        placed = equidistribute(s[part], 1.0 / h[part], least)
        found.append(at(placed, np.full(len(placed), k)))
    return found


def _to_walls(container: Container, x: Array) -> Array:
    """Directions from a point to the walls, (walls, 2): down the slopes of their distances."""
    step = 1e-6 * container.size()
    d = container.distances(x + step * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]))
    return np.column_stack([d[1] - d[0], d[3] - d[2]])


def across(gap: Array, radius: Array | float, resolution: Resolution) -> Array:
    """Element size where the gap is `gap` and the smallest radius beside it `radius`."""
    size: Array = np.clip(LENGTH * np.sqrt(radius * gap), SHORTEST * gap, LONGEST * gap)
    size /= resolution.cells_per_gap
    return size
