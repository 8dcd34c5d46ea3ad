"""Where the nodes on the bodies go: element sizes from the gaps.

The element size on a body is

    h(x) = min(h_gap(gap(x)), h_body),   h_body = 2 pi a / cells_per_circle,

where `gap(x)` is the distance from the surface point x to the nearest other surface, and on a wall

    h(x) = min(h_gap(d(x)), max(h_body, growth d(x)), side / 4),

where `d(x)` is the distance to the nearest body. The flow in a narrow gap is a polynomial across it and
varies along it over the lubrication length sqrt(a gap), so that is what a cell must resolve:

    h_gap(d) = 0.15 sqrt(a d) / cells_per_gap,   but within [0.35 d, 4 d] / cells_per_gap.

With cells_per_gap = 1 that is one cell across a gap of 0.02 a, three across gaps above 0.2 a; in narrower
gaps cells are longer than wide, and the error of the force still falls with the gap.
Nodes equidistribute `int ds / h`. gmsh then extends the sizes of the boundary into the fluid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from meshes.errors import MeshError
from meshes.geometry import Array, Container

LENGTH, SHORTEST, LONGEST = 0.15, 0.35, 4.0
SAMPLES_PER_CLUSTER = 32


@dataclass(frozen=True, slots=True)
class Resolution:
    """How fine a mesh is.

    cells_per_gap: elements across a gap of 0.02 radii; cells_per_circle: elements around an isolated body;
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

    centres (N, 2), radii (N,); a point's nearest bodies are found by a tree over the centres.
    """

    container: Container
    centres: Array
    radii: Array

    def to_bodies(self, x: Array, among: NDArray[np.intp] | None = None) -> Array:
        """Distance of each point (n, 2) to the nearest body of `among` (default: all), shape (n,)."""
        centres, radii = (
            (self.centres, self.radii) if among is None else (self.centres[among], self.radii[among])
        )
        if len(radii) == 0:
            return np.full(len(x), np.inf)
        distances = np.hypot(x[:, None, 0] - centres[:, 0], x[:, None, 1] - centres[:, 1]) - radii
        nearest: Array = distances.min(axis=1)
        return nearest


def bodies(surfaces: Surfaces, resolution: Resolution) -> list[Curve]:
    """The curve around each body, with tags 1, ..., N: closed, or from pole to pole where the container is axisymmetric.

    Raises:
        MeshError: a body touches another or a wall.
    """
    centres, radii = surfaces.centres, surfaces.radii
    largest = radii.max(initial=0.0)
    sizes = 2.0 * np.pi * radii / resolution.cells_per_circle
    reach = resolution.cells_per_gap * sizes / SHORTEST
    tree = cKDTree(centres)
    wall_gaps = surfaces.container.distances(centres) - radii[:, None]
    half = surfaces.container.axisymmetric
    curves = []
    for i, (centre, radius) in enumerate(zip(centres, radii, strict=True)):
        near = np.asarray(tree.query_ball_point(centre, radius + largest + reach[i]), dtype=np.intp)
        near = near[near != i]
        gaps = np.hypot(*(centres[near] - centre).T) - radii[near] - radius
        near, gaps = near[gaps < reach[i]], gaps[gaps < reach[i]]
        to_near = centres[near] - centre
        foci = np.arctan2(to_near[:, 1], to_near[:, 0])
        close_walls = np.flatnonzero(wall_gaps[i] < reach[i])
        foci = np.concatenate(
            [foci, [_direction_to_wall(surfaces.container, centre, int(w)) for w in close_walls]]
        )
        gaps = np.concatenate([gaps, wall_gaps[i, close_walls]])
        if gaps.min(initial=np.inf) <= 0.0:
            raise MeshError(f"the disc at ({centre[0]:.6g}, {centre[1]:.6g}) touches a disc or wall; move it")
        angles = _circle_samples(foci, np.sqrt(0.5 * gaps / radius), resolution.cells_per_circle, half)
        x = centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])
        distance = surfaces.to_bodies(x, near)
        if len(close_walls):
            distance = np.minimum(distance, surfaces.container.distances(x)[:, close_walls].min(axis=1))
        smallest = min(radius, float(radii[near].min(initial=np.inf)))
        h = np.minimum(across(distance, smallest, resolution), sizes[i])
        angles = equidistribute(angles, radius / h, least=8)
        nodes = centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])
        if half:
            nodes[[0, -1]] = [[0.0, centre[1] - radius], [0.0, centre[1] + radius]]
        curves.append(Curve(i + 1, nodes if half else nodes[:-1], closed=not half, centre=centre))
    return curves


def across(gap: Array, radius: float, resolution: Resolution) -> Array:
    """Element size where the gap is `gap` and the smallest radius beside it `radius`."""
    size: Array = (
        np.clip(LENGTH * np.sqrt(radius * gap), SHORTEST * gap, LONGEST * gap) / resolution.cells_per_gap
    )
    return size


def _direction_to_wall(container: Container, centre: Array, wall: int) -> float:
    """Angle of the direction from a centre towards a wall: down the slope of the distance."""
    step = 1e-6 * container.size()
    shifted = centre + step * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    d = container.distances(shifted)[:, wall]
    return float(np.arctan2(d[3] - d[2], d[1] - d[0]))


def _circle_samples(foci: Array, widths: Array, cells: int, half: bool) -> Array:
    """Angles that resolve a size function with minima of the given angular widths at the foci.

    Around the whole circle the first angle is the sharpest minimum (so that a node stands there) and the last is one
    turn further; the half circle goes from pole to pole.
    """
    start = -0.5 * np.pi if half else foci[np.argmin(widths)] if len(foci) else 0.0
    turn = np.pi if half else 2.0 * np.pi
    samples = [start + np.linspace(0.0, turn, 4 * cells + 1)]
    samples += [focus + cluster(width, np.pi) for focus, width in zip(foci, widths, strict=True)]
    offsets = np.mod(np.concatenate(samples) - start, 2.0 * np.pi)
    return start + np.concatenate([np.unique(np.append(offsets[offsets < turn], 0.0)), [turn]])


def cluster(width: float, extent: float) -> Array:
    """Offsets in [-extent, extent], spaced evenly within `width` of zero and geometrically beyond."""
    u = np.linspace(0.0, np.arcsinh(extent / width), SAMPLES_PER_CLUSTER)
    half = width * np.sinh(u)
    return np.concatenate([-half[:0:-1], half])


def equidistribute(s: Array, density: Array, least: int) -> Array:
    """Parameters, with both ends of s, that split `int density ds` into equal parts of at most 1."""
    cumulative = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))])
    parts = max(least, int(np.ceil(cumulative[-1])))
    placed: Array = np.interp(np.linspace(0.0, cumulative[-1], parts + 1), cumulative, s)
    return placed
