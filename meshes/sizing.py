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
Nodes equidistribute `int ds / h`. gmsh then extends the sizes of the boundary into the fluid.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from meshes.errors import MeshError
from meshes.geometry import Array, Container
from meshes.lattice import NO_LATTICE, Lattice

LENGTH, SHORTEST, LONGEST = 0.11, 0.3, 4.0
NEIGHBOURS = 16
MOST_HALVINGS = 60

type Size = Callable[[Array], Array]


@dataclass(frozen=True, slots=True)
class Resolution:
    """How fine a mesh is.

    cells_per_gap: elements across a gap of 0.012 radii; cells_per_circle: elements around an isolated body;
    growth: element size over the distance to the nearest body, far from all bodies.
    """

    cells_per_gap: float = 1.0
    cells_per_circle: int = 48
    growth: float = 0.2


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
    around_body = half_around if surfaces.container.axisymmetric else around
    return [around_body(surfaces, resolution, i) for i in range(surfaces.bodies)]


def around(surfaces: Surfaces, resolution: Resolution, i: int) -> Curve:
    """The nodes around body i, from where its gap is narrowest, so that a node stands there."""
    size, narrowest = _size_around(surfaces, resolution, i)
    nodes = _on_arc(surfaces, resolution, i, size, (narrowest, narrowest + 2.0 * np.pi))
    return Curve(i + 1, nodes[:-1], closed=True, centre=surfaces.centres[i])


def half_around(surfaces: Surfaces, resolution: Resolution, i: int) -> Curve:
    """The nodes from pole to pole of body i on the axis."""
    curve = arc(surfaces, resolution, i, -0.5 * np.pi, 0.5 * np.pi)
    centre, radius = surfaces.centres[i], surfaces.radii[i]
    curve.nodes[[0, -1]] = [[0.0, centre[1] - radius], [0.0, centre[1] + radius]]
    return curve


def arc(surfaces: Surfaces, resolution: Resolution, i: int, start: float, end: float) -> Curve:
    """The nodes on body i between two angles, start < end."""
    size, _ = _size_around(surfaces, resolution, i)
    nodes = _on_arc(surfaces, resolution, i, size, (start, end))
    return Curve(i + 1, nodes, closed=False, centre=surfaces.centres[i])


def _on_arc(
    surfaces: Surfaces, resolution: Resolution, i: int, size: Size, angles: tuple[float, float]
) -> Array:
    """Nodes on body i from the first angle to the second, both included; on a whole circle at least 8."""
    centre, radius = surfaces.centres[i], float(surfaces.radii[i])

    def at(s: Array) -> Array:
        x: Array = centre + radius * np.column_stack([np.cos(s / radius), np.sin(s / radius)])
        return x

    turn = (angles[1] - angles[0]) / (2.0 * np.pi)
    s, h = resolve(lambda s: size(at(s)), angles[0] * radius, angles[1] * radius, resolution.cells_per_circle)
    return at(equidistribute(s, 1.0 / h, least=max(1, round(8 * turn))))


def _size_around(surfaces: Surfaces, resolution: Resolution, i: int) -> tuple[Size, float]:
    """The element size on body i as a function of the point.

    From what is near; and where its gap is narrowest.
    """
    centre, radius, radii, container = (
        surfaces.centres[i],
        surfaces.radii[i],
        surfaces.radii,
        surfaces.container,
    )
    h_body = 2.0 * np.pi * radius / resolution.cells_per_circle
    reach = resolution.cells_per_gap * h_body / SHORTEST
    near = np.asarray(surfaces.tree.query_ball_point(centre, radius + radii.max() + reach), dtype=np.intp)
    gaps = np.hypot(*(surfaces.centres[near] - centre).T) - radii[near] - radius
    near, gaps = near[(near != i) & (gaps < reach)], gaps[(near != i) & (gaps < reach)]
    wall_gaps = container.distances(centre[None])[0] - radius
    walls = np.flatnonzero(wall_gaps < reach)
    gaps = np.concatenate([gaps, wall_gaps[walls]])
    if gaps.min(initial=np.inf) <= 0.0:
        raise MeshError(f"the disc at ({centre[0]:.6g}, {centre[1]:.6g}) touches a disc or wall; move it")
    towards = np.concatenate([surfaces.centres[near] - centre, _to_walls(container, centre)[walls]])
    narrowest = float(np.arctan2(*towards[np.argmin(gaps), ::-1])) if len(gaps) else 0.0
    smallest = min(float(radius), float(radii[near].min(initial=np.inf)))

    def size(x: Array) -> Array:
        to_near = np.hypot(*np.moveaxis(x[:, None] - surfaces.centres[near], 2, 0)) - radii[near]
        distance = np.column_stack([to_near, container.distances(x)[:, walls]]).min(axis=1, initial=np.inf)
        of_gap: Array = np.minimum(across(distance, smallest, resolution), h_body)
        return of_gap

    return size, narrowest


def _to_walls(container: Container, x: Array) -> Array:
    """Directions from a point to the walls, (walls, 2): down the slopes of their distances."""
    step = 1e-6 * container.size()
    d = container.distances(x + step * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]))
    return np.column_stack([d[1] - d[0], d[3] - d[2]])


def across(gap: Array, radius: float, resolution: Resolution) -> Array:
    """Element size where the gap is `gap` and the smallest radius beside it `radius`."""
    size: Array = np.clip(LENGTH * np.sqrt(radius * gap), SHORTEST * gap, LONGEST * gap)
    size /= resolution.cells_per_gap
    return size


def resolve(size: Size, start: float, end: float, pieces: int) -> tuple[Array, Array]:
    """Places s along a curve, and the element sizes there, so close that none is missed.

    Intervals are halved until they are no longer than half the element size at both their ends.
    """
    s = np.linspace(start, end, pieces + 1)
    h = size(s)
    for _ in range(MOST_HALVINGS):
        long = np.flatnonzero(np.diff(s) > 0.5 * np.minimum(h[:-1], h[1:]))
        if len(long) == 0:
            return s, h
        middle = 0.5 * (s[long] + s[long + 1])
        s, h = np.insert(s, long + 1, middle), np.insert(h, long + 1, size(middle))
    raise MeshError(f"element sizes down to {h.min():.3g} cannot be resolved; is a gap that small meant?")


def equidistribute(s: Array, density: Array, least: int) -> Array:
    """Parameters, with both ends of s, that split `int density ds` into equal parts of at most 1."""
    cumulative = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))])
    parts = max(least, int(np.ceil(cumulative[-1] - 1e-6)))
    placed: Array = np.interp(np.linspace(0.0, cumulative[-1], parts + 1), cumulative, s)
    return placed
