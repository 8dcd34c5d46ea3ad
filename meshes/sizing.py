"""Where the boundary nodes go: element sizes from the gaps.

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
from meshes.geometry import Array, Box, Container, HalfPlane

LENGTH, SHORTEST, LONGEST = 0.15, 0.35, 4.0
SAMPLES_PER_CLUSTER = 32
WALL_SAMPLES = 200


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


def boundary(container: Container, centres: Array, radii: Array, resolution: Resolution) -> list[Curve]:
    """The nodes on every body (tags 1 ... N) and wall (tags N + 1 ..., in the container's order).

    Raises:
        MeshError: a body touches another or a wall.
    """
    surfaces = Surfaces(container, centres, radii)
    curves = _bodies(surfaces, resolution)
    return curves + _walls(surfaces, resolution)


def _bodies(surfaces: Surfaces, resolution: Resolution) -> list[Curve]:
    """One closed curve around each body."""
    centres, radii = surfaces.centres, surfaces.radii
    largest = radii.max(initial=0.0)
    sizes = 2.0 * np.pi * radii / resolution.cells_per_circle
    reach = resolution.cells_per_gap * sizes / SHORTEST
    tree = cKDTree(centres)
    wall_gaps = surfaces.container.distances(centres) - radii[:, None]
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
        angles = _circle_samples(foci, np.sqrt(0.5 * gaps / radius), resolution.cells_per_circle)
        x = centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])
        distance = surfaces.to_bodies(x, near)
        if len(close_walls):
            distance = np.minimum(distance, surfaces.container.distances(x)[:, close_walls].min(axis=1))
        smallest = min(radius, float(radii[near].min(initial=np.inf)))
        h = np.minimum(_across(distance, smallest, resolution), sizes[i])
        angles = _equidistribute(angles, radius / h, least=8)[:-1]
        nodes = centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])
        curves.append(Curve(i + 1, nodes, closed=True, centre=centre))
    return curves


def _across(gap: Array, radius: float, resolution: Resolution) -> Array:
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


def _circle_samples(foci: Array, widths: Array, cells: int) -> Array:
    """Angles that resolve a size function with minima of the given angular widths at the foci.

    The first angle is the sharpest minimum (so that a node stands there); the last is one turn further.
    """
    start = foci[np.argmin(widths)] if len(foci) else 0.0
    samples = [start + np.linspace(0.0, 2.0 * np.pi, 4 * cells + 1)]
    samples += [focus + _cluster(width, np.pi) for focus, width in zip(foci, widths, strict=True)]
    offsets = np.mod(np.concatenate(samples) - start, 2.0 * np.pi)
    return start + np.concatenate([np.unique(np.append(offsets, 0.0)), [2.0 * np.pi]])


def _cluster(width: float, extent: float) -> Array:
    """Offsets in [-extent, extent], spaced evenly within `width` of zero and geometrically beyond."""
    u = np.linspace(0.0, np.arcsinh(extent / width), SAMPLES_PER_CLUSTER)
    half = width * np.sinh(u)
    return np.concatenate([-half[:0:-1], half])


def _equidistribute(s: Array, density: Array, least: int) -> Array:
    """Parameters, with both ends of s, that split `int density ds` into equal parts of at most 1."""
    cumulative = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))])
    parts = max(least, int(np.ceil(cumulative[-1])))
    placed: Array = np.interp(np.linspace(0.0, cumulative[-1], parts + 1), cumulative, s)
    return placed


def _walls(surfaces: Surfaces, resolution: Resolution) -> list[Curve]:
    """The container's walls, in its order."""
    first = len(surfaces.radii) + 1
    match surfaces.container:
        case Box(lower=(x0, y0), upper=(x1, y1)):
            corners = {
                "left": ((x0, y1), (x0, y0)),
                "right": ((x1, y0), (x1, y1)),
                "bottom": ((x0, y0), (x1, y0)),
                "top": ((x1, y1), (x0, y1)),
            }
            return [
                _segment(surfaces, resolution, first + k, np.array(corners[wall]))
                for k, wall in enumerate(surfaces.container.walls)
            ]
        case HalfPlane(radius=radius):
            plane = _segment(surfaces, resolution, first, np.array([[-radius, 0.0], [radius, 0.0]]))
            return [plane, _arc(surfaces, resolution, first + 1, radius)]
        case other:
            raise TypeError(f"no mesh for the container {other!r}")


def _wall_size(surfaces: Surfaces, resolution: Resolution, x: Array, longest: float) -> Array:
    """Element size at points of a wall."""
    if len(surfaces.radii) == 0:
        return np.full(len(x), longest)
    d = surfaces.to_bodies(x)
    h_body = 2.0 * np.pi * surfaces.radii.max() / resolution.cells_per_circle
    a = float(surfaces.radii.min())
    return np.minimum(
        np.minimum(_across(d, a, resolution), np.maximum(h_body, resolution.growth * d)), longest
    )


def _segment(surfaces: Surfaces, resolution: Resolution, tag: int, ends: Array) -> Curve:
    """A straight wall from ends[0] to ends[1]."""
    length = float(np.hypot(*(ends[1] - ends[0])))
    along = (ends[1] - ends[0]) / length
    normal = np.array([-along[1], along[0]])
    samples = [np.linspace(0.0, length, WALL_SAMPLES)]
    for centre, radius in zip(surfaces.centres, surfaces.radii, strict=True):
        foot, height = (centre - ends[0]) @ along, abs((centre - ends[0]) @ normal)
        samples.append(foot + _cluster(np.sqrt(0.5 * (height - radius) * radius), max(length, height)))
    s = np.unique(np.clip(np.concatenate(samples), 0.0, length))
    h = _wall_size(surfaces, resolution, ends[0] + s[:, None] * along, 0.25 * length)
    s = _equidistribute(s, 1.0 / h, least=4)
    return Curve(tag, ends[0] + s[:, None] * along, closed=False, centre=None)


def _arc(surfaces: Surfaces, resolution: Resolution, tag: int, radius: float) -> Curve:
    """The far boundary of the half-plane, from (radius, 0) to (-radius, 0)."""
    angles = np.linspace(0.0, np.pi, WALL_SAMPLES)
    x = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    h = _wall_size(surfaces, resolution, x, 0.5 * radius)
    angles = _equidistribute(angles, radius / h, least=8)
    nodes = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    nodes[[0, -1]] = [[radius, 0.0], [-radius, 0.0]]
    return Curve(tag, nodes, closed=False, centre=np.zeros(2))
