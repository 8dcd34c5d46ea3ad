"""Where the nodes on bodies and walls go: element sizes from the gaps.

The element size on a body is

    h(x) = min(h_gap(gap(x)), h_body),   h_body = 2 pi a / cells_per_circle,

where `gap(x)` is the distance from the surface point x to the nearest other surface, and on a wall

    h(x) = min(h_gap(d(x)), max(h_body, growth d(x)), side / 4),

where `d(x)` is the distance to the nearest body; towards singular corners it is smaller (see `grading`).
The flow in a narrow gap is a polynomial across it and varies along it over the lubrication length
sqrt(a gap), so that is what a cell must resolve:

    h_gap(d) = 0.11 sqrt(a d) / cells_per_gap,   but within [0.3 d, 4 d] / cells_per_gap.

With cells_per_gap = 1 that is one cell across a gap of 0.012 a, three across gaps above 0.13 a; in narrower
gaps cells are longer than wide, and the error of the force still falls with the gap.
On a line through the fluid from surface to surface, the axis or a link of the cut, d(x) in h_gap is the
length of the line. Nodes equidistribute `int ds / h`. gmsh then extends the sizes of the boundary into the
fluid, if its interior shall be graded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import NDArray

from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.containers import Array, Container, FluidDomain
from fsi.meshes.geometry.curves import WallCurve
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.planar.grading import Grading

MOST_HALVINGS = 60

Indices = NDArray[np.int64]
type Sizes = Callable[[Array, Indices], Array]


def resolve_all(size: Sizes, ends: Array, pieces: int) -> tuple[Array, Array, Indices]:
    """Places s along curves from ends[k, 0] to ends[k, 1], the element sizes there, and the curve k of each.

    Intervals are halved until they are no longer than half the element size at both their ends.
    """
    s = np.linspace(ends[:, 0], ends[:, 1], pieces + 1, axis=1).ravel()
    k = np.repeat(np.arange(len(ends)), pieces + 1)
    h = size(s, k)
    for _ in range(MOST_HALVINGS):
        too_long = (np.diff(s) > 0.5 * np.minimum(h[:-1], h[1:])) & (k[:-1] == k[1:])
        long = np.flatnonzero(too_long)
        if len(long) == 0:
            return s, h, k
        middle, of = 0.5 * (s[long] + s[long + 1]), k[long]
        h = np.insert(h, long + 1, size(middle, of))
        s, k = np.insert(s, long + 1, middle), np.insert(k, long + 1, of)
    raise MeshError("element sizes down to {} cannot be resolved; is a gap that small meant?", h.min())


def equidistribute(s: Array, density: Array, least: int) -> Array:
    """Parameters, with both ends of s, that split `int density ds` into equal parts of at most 1."""
    cumulative = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))])
    parts = max(least, int(np.ceil(cumulative[-1] - 1e-6)))
    placed: Array = np.interp(np.linspace(0.0, cumulative[-1], parts + 1), cumulative, s)
    return placed


LENGTH, SHORTEST, LONGEST = 0.11, 0.3, 4.0
NEIGHBOURS = 16
PIECES = 64  # of a wall, to begin with


@dataclass(frozen=True, slots=True)
class Resolution:
    """How fine a mesh is.

    Attributes:
        cells_per_gap: elements across a gap of 0.012 radii.
        cells_per_circle: elements around an isolated body.
        growth: element size over the distance to the nearest body, far from all bodies; twice that over the
            distance to a singular corner.
        interior: "graded", where sizes in the fluid go over smoothly into those on the boundary, or in the
            plane "sparse", where those hold on the boundary alone. In a suspension of area fraction 0.4
            sparse meshes have a fifth fewer unknowns for an error of 5e-4 of the apparent viscosity.
    """

    cells_per_gap: float = 1.0
    cells_per_circle: int = 48
    growth: float = 0.2
    interior: Literal["graded", "sparse"] = "graded"

    def on_body[T: (float, Array)](self, radius: T) -> T:
        """h_body, the element size on a body without neighbours."""
        return 2.0 * np.pi * radius / self.cells_per_circle

    def across(self, gap: Array | float, radius: Array | float) -> Array:
        """h_gap where the gap is `gap` and the smallest radius beside it `radius`."""
        size: Array = np.clip(LENGTH * np.sqrt(radius * gap), SHORTEST * gap, LONGEST * gap)
        size /= self.cells_per_gap
        return size


@dataclass(frozen=True, slots=True)
class Curve:
    """One piece of the boundary as a chain of nodes.

    Attributes:
        tag: of its facets.
        nodes: in order, (n, 2); those of a closed curve do not repeat the first.
        closed: whether the last node is joined to the first.
        centre: of the circle that the curve follows, None for a straight piece.
    """

    tag: int
    nodes: Array
    closed: bool = False
    centre: Array | None = None


@dataclass(frozen=True, slots=True)
class Surfaces:
    """The bodies and the container, how far a point is from them, and which element size that asks for.

    Attributes:
        container: what encloses the fluid.
        centres: of the bodies, in one cell of a periodic container, then of their images next to it, (n, 2).
        radii: of all of these, (n,).
        tree: over the centres.
        bodies: N.
        lattice: of the container's periods.
        resolution: how fine the mesh is.
        grading: towards singular corners.
    """

    container: Container
    centres: Array
    radii: Array
    tree: scipy.spatial.cKDTree
    bodies: int
    lattice: Lattice
    resolution: Resolution
    grading: Grading

    @staticmethod
    def of(domain: FluidDomain, resolution: Resolution) -> Surfaces:
        """The bodies of a domain, and their images if it is periodic."""
        lattice = Lattice(domain.container.periods)
        m = lattice.near()
        images = (lattice.shift(m)[:, None] + lattice.wrapped(domain.centres)).reshape(-1, 2)
        radii = np.tile(domain.radii, len(m))
        grading = Grading.of(domain, resolution.growth)
        tree, bodies = scipy.spatial.cKDTree(images), len(domain.radii)
        return Surfaces(domain.container, images, radii, tree, bodies, lattice, resolution, grading)

    def to_bodies(self, x: Array) -> Array:
        """Distance of each point (n, 2) to the nearest body, shape (n,); infinite without bodies."""
        if self.bodies == 0:
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

    def sizes(self, x: Array, gap: float | None = None) -> Array:
        """Element size at points (n, 2) off the bodies, in a gap of that width or else by their distance."""
        if self.bodies == 0:
            return np.full(len(x), np.inf if gap is None else 0.1 * gap)
        d = self.to_bodies(x)
        in_gap = self.resolution.across(d if gap is None else gap, float(self.radii.min()))
        h_body = self.resolution.on_body(self.radii.max())
        return np.minimum(in_gap, np.maximum(h_body, self.resolution.growth * d))

    def wall(self, curve: WallCurve) -> Curve:
        """The nodes on a piece of a wall, whose tag follows the bodies'."""

        def size(s: Array, _: Indices) -> Array:
            x = curve.at(s)
            return np.minimum(np.minimum(self.sizes(x), curve.longest_element), self.grading.sizes(x))

        s, h, _ = resolve_all(size, np.array([curve.interval]), PIECES)
        nodes = curve.at(equidistribute(s, 1.0 / h, curve.fewest_elements))
        nodes[[0, -1]] = curve.ends
        return Curve(self.bodies + 1 + curve.wall, nodes, centre=curve.centre)

    def line(self, at: Callable[[Array], Array], start: float, end: float, pieces: int) -> Array:
        """Places s of the nodes on a line `at(s)` through the fluid from surface to surface."""
        ends = np.array([[start, end]])
        s, h, _ = resolve_all(lambda s, _: self.sizes(at(s), end - start), ends, pieces)
        s = equidistribute(s, 1.0 / h, least=1)
        s[[0, -1]] = start, end
        return s


def rings(surfaces: Surfaces, bodies: Sequence[int]) -> list[Curve]:
    """The nodes around bodies, each from where its gap is narrowest, so that a node stands there.

    Raises MeshError where a body touches another or a wall.
    """
    near = [_neighbourhood(surfaces, i) for i in bodies]
    turns = np.array([(body.narrowest, body.narrowest + 2.0 * np.pi) for body in near]).reshape(-1, 2)
    chains = zip(bodies, _on_arcs(surfaces, near, turns), strict=True)
    return [Curve(i + 1, nodes[:-1], closed=True, centre=surfaces.centres[i]) for i, nodes in chains]


def half_ring(surfaces: Surfaces, i: int) -> Curve:
    """The nodes from pole to pole of body i on the axis."""
    (curve,) = arcs(surfaces, [i], np.array([[-0.5, 0.5]]) * np.pi)
    centre, radius = surfaces.centres[i], surfaces.radii[i]
    curve.nodes[[0, -1]] = [[0.0, centre[1] - radius], [0.0, centre[1] + radius]]
    return curve


def arcs(surfaces: Surfaces, bodies: Sequence[int], angles: Array) -> list[Curve]:
    """The nodes on bodies between two angles each, start < end, (n, 2)."""
    near = [_neighbourhood(surfaces, i) for i in bodies]
    chains = zip(bodies, _on_arcs(surfaces, near, angles), strict=True)
    return [Curve(i + 1, nodes, centre=surfaces.centres[i]) for i, nodes in chains]


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
    """

    i: int
    centres: Array
    radii: Array
    walls: NDArray[np.bool_]
    smallest: float
    narrowest: float


def _neighbourhood(surfaces: Surfaces, i: int) -> Neighbourhood:
    """What is near body i. Raises MeshError where it touches."""
    centre, radius, radii = surfaces.centres[i], float(surfaces.radii[i]), surfaces.radii
    resolution = surfaces.resolution
    # Where h_gap reaches h_body: farther surfaces do not change the size of the elements.
    reach = resolution.cells_per_gap * 2.0 * np.pi * radius / resolution.cells_per_circle / SHORTEST
    near = np.asarray(surfaces.tree.query_ball_point(centre, radius + radii.max() + reach), dtype=np.intp)
    gaps = np.hypot(*(surfaces.centres[near] - centre).T) - radii[near] - radius
    near, gaps = near[(near != i) & (gaps < reach)], gaps[(near != i) & (gaps < reach)]
    wall_gaps = surfaces.container.distances(centre[None])[0] - radius
    walls = wall_gaps < reach
    gaps = np.concatenate([gaps, wall_gaps[walls]])
    if gaps.min(initial=np.inf) <= 0.0:
        raise MeshError("the disc at {} touches a disc or wall; move it", centre)
    # 0 - n, not -n: minus zero would turn an angle of pi into -pi.
    to_walls = 0.0 - surfaces.container.normals(centre[None])[0]
    towards = np.concatenate([surfaces.centres[near] - centre, to_walls[walls]])
    narrowest = float(np.arctan2(*towards[np.argmin(gaps), ::-1])) if len(gaps) else 0.0
    smallest = min(radius, float(radii[near].min(initial=np.inf)))
    return Neighbourhood(i, surfaces.centres[near], radii[near], walls, smallest, narrowest)


def _on_arcs(surfaces: Surfaces, near: Sequence[Neighbourhood], angles: Array) -> list[Array]:
    """Nodes on bodies between two angles each, (n, 2), both included; on a whole circle at least 8.

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

    def size(s: Array, k: Indices) -> Array:
        x = place(s, k)
        away = x[:, None] - others[k]
        to_near = np.hypot(away[..., 0], away[..., 1]) - sizes[k]
        to_walls = np.where(walls[k], surfaces.container.distances(x), np.inf)
        distance = np.column_stack([to_near, to_walls]).min(axis=1, initial=np.inf)
        of_gap: Array = np.minimum(resolution.across(distance, smallest[k]), h_body[k])
        return of_gap

    pieces = []
    s, h, curve = resolve_all(size, angles * radii[:, None], resolution.cells_per_circle)
    first = np.searchsorted(curve, np.arange(len(near) + 1))
    for k, (start, end) in enumerate(angles):
        part = slice(first[k], first[k + 1])
        least = max(1, round(8 * (end - start) / (2.0 * np.pi)))
        placed = equidistribute(s[part], 1.0 / h[part], least)
        pieces.append(place(placed, np.full(len(placed), k)))
    return pieces
