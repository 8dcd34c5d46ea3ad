"""Where the nodes on bodies and walls go: element sizes from the gaps.

The element size on a body is

    h(x) = min(h_gap(gap(x)), h_body),

with h_gap and h_body of `fsi.meshes.resolution`, where `gap(x)` is the distance from the surface point x to
the nearest other surface, and on a wall

    h(x) = min(h_gap(d(x)), h_far(x), side / 4),    h_far(x) = min_i max(h_i, growth d_i(x)),

where `d_i(x)` is the distance to body i, h_i its h_body and d(x) the least distance; towards singular corners
it is smaller (see `grading`).

gmsh works with absolute lengths and rounds them; cells a thousand times as long as wide, next to gaps of
1e-8 a, are beyond it. So it is shown the narrowest gaps opened, the nodes moved into the solids on both sides
until no cell is longer than four times its width, and its triangles are taken back to where the nodes are.
On a line through the fluid from surface to surface, the axis or a link of the cut, d(x) in h_gap is the
length of the line. Nodes equidistribute `int ds / h`. gmsh then extends the sizes of the boundary into the
fluid, if its interior shall be graded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array, Indices, parted
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.curves import WallCurve
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.geometry.nearby import NearbyPoints
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.planar.facing import NARROW, FacedGap, foot_on, on_wall
from fsi.meshes.planar.grading import Grading
from fsi.meshes.planar.spread import equidistribute_all, resolve_all, spread_all
from fsi.meshes.resolution import Resolution

NEIGHBOURS = 16
PIECES = 64  # of a wall, to begin with
INSIDE = 0  # the tag of lines that bound pieces of the fluid only


@dataclass(frozen=True, slots=True)
class Curve:
    """One piece of the boundary as a chain of nodes.

    Attributes:
        tag: of its facets, INSIDE where it is no boundary.
        nodes: in order, (n, 2); those of a closed curve do not repeat the first.
        closed: whether the last node is joined to the first.
        centre: of the circle that the curve follows, None for a straight piece.
        opening: how far nodes are moved into the solid while gmsh works, (n, 2); None on lines in the fluid.
        pieces: of the fluid that it bounds; gmsh fills one after the other.
        body: whose outline the curve follows, of a wall what is solid; None for circles and straight pieces.
    """

    tag: int
    nodes: Array
    closed: bool = False
    centre: Array | None = None
    opening: Array | None = None
    pieces: tuple[int, ...] = (0,)
    body: Placed | None = None


@dataclass(frozen=True, slots=True)
class Surfaces:
    """The bodies and the container, how far a point is from them, and which element size that asks for.

    Attributes:
        container: what encloses the fluid.
        centres: of the bodies, in one cell of a periodic container, then of their images next to it, (n, 2).
        shifts: the integers by which each N of these are moved, (n / N, k).
        radii: of all of these, (n,).
        nearby: which of these centres are near.
        bodies: N.
        lattice: of the container's periods.
        resolution: how fine the mesh is.
        grading: towards singular corners.
        placed: the bodies and images by their outlines; empty where all are discs.
    """

    container: Container
    centres: Array
    shifts: Indices
    radii: Array
    nearby: NearbyPoints
    bodies: int
    lattice: Lattice
    resolution: Resolution
    grading: Grading
    placed: tuple[Placed, ...] = ()

    @staticmethod
    def of(domain: FluidDomain, resolution: Resolution) -> Surfaces:
        """The bodies of a domain, and their images if it is periodic."""
        lattice = Lattice(domain.container.periods)
        m = lattice.near(2.0 * float(domain.radii.max()) if domain.placed else 0.0)
        images = (lattice.shift(m)[:, None] + lattice.wrapped(domain.centres)).reshape(-1, 2)
        radii = np.tile(domain.radii, len(m))
        grading = Grading.of(domain, resolution.growth)
        nearby, bodies = NearbyPoints(images), len(domain.radii)
        each = zip(domain.placed * len(m), images, strict=False)
        placed = tuple(body.moved(centre) for body, centre in each)
        laid = domain.container, images, m, radii, nearby, bodies, lattice, resolution, grading
        return Surfaces(*laid, placed)

    @property
    def arms(self) -> Array:
        """How far from the centres of bodies links begin along themselves, (N,): radii, 0 of outlines."""
        of_discs = self.radii[: self.bodies]
        return np.zeros_like(of_discs) if self.placed else of_discs

    @property
    def word(self) -> str:
        """What the bodies are."""
        return "body" if self.placed else "disc"

    def inside(self, bodies: list[int]) -> Array:
        """A point inside each of these, (n, 2)."""
        if not self.placed:
            return self.centres[bodies]
        return np.array([self.placed[i].inside for i in bodies]).reshape(-1, 2)

    def nearest(self, x: Array) -> tuple[Array, Array | float]:
        """Distance of points (n, 2) to the nearest body, and the radius that counts there, (n,) or one."""
        if not self.placed:
            return self.to_bodies(x), float(self.radii.min(initial=np.inf))
        x = self.lattice.wrapped(x)
        distance, bend = np.full(len(x), np.inf), np.full(len(x), np.inf)
        for body, radius in zip(self.placed, self.radii.tolist(), strict=True):
            near = np.flatnonzero(np.hypot(*(x - body.centre).T) - radius < distance)
            d, b = body.distance_and_bend(x[near])
            nearer = near[d < distance[near]]
            distance[nearer], bend[nearer] = d[d < distance[near]], b[d < distance[near]]
        return distance, bend

    def on_axis(self, i: int) -> Array:
        """The lower and the upper end of body i on an axis, (2, 2)."""
        middle, radius = self.centres[i, 1], self.radii[i]
        heights = np.array([middle - radius, middle + radius])
        if self.placed and (poles := self.placed[i].outline.poles) is not None:
            heights = self.placed[i].at(np.array(poles)).x[:, 1]
        return np.column_stack([np.zeros(2), heights])

    def to_bodies(self, x: Array) -> Array:
        """Distance of each point (n, 2) to the nearest of discs, shape (n,); infinite without bodies."""
        if self.bodies == 0:
            return np.full(len(x), np.inf)
        x = self.lattice.wrapped(x)
        if self.nearby.few:
            of_all: Array = (self.nearby.distances(x) - self.radii).min(axis=1)
            return of_all
        k = min(len(self.radii), NEIGHBOURS)
        away, body = self.nearby.nearest(x, k)
        nearest: Array = (away - self.radii[body]).min(axis=1)
        # A body beyond the k nearest centres can only be nearer if it is larger.
        unsure = (away[:, -1] - self.radii.max() < nearest) & (k < len(self.radii))
        for point in np.flatnonzero(unsure):
            nearest[point] = (np.hypot(*(x[point] - self.centres).T) - self.radii).min()
        return nearest

    def sizes(self, x: Array, gap: Array | None = None, bend: Array | float = np.inf) -> Array:
        """Element size at points (n, 2) off the bodies, in gaps of these widths or else by their distance.

        bend: that of the wall on which the points are.
        """
        if self.bodies == 0:
            return np.full(len(x), np.inf) if gap is None else 0.1 * gap
        d, radius = self.nearest(x)
        in_gap = self.resolution.across(d if gap is None else gap, np.minimum(radius, bend))
        return np.minimum(in_gap, self._far(x, d, radius))

    def _far(self, x: Array, d: Array, radius: Array | float) -> Array:
        """h_far at points (n, 2) whose nearest body is at d, (n,); radius: of an outline there.

        Of discs that are not among the nearest centres it is no less than for the largest at d.
        """
        h_body, growth = self.resolution.on_body, self.resolution.growth
        if self.placed:
            return np.asarray(np.maximum(h_body(np.asarray(radius)), growth * d))
        far: Array = np.maximum(h_body(self.radii.max()), growth * d)
        if np.ptp(self.radii) == 0.0:
            return far
        away, disc = self.nearby.nearest(self.lattice.wrapped(x), min(len(self.radii), NEIGHBOURS))
        a = self.radii[disc]
        return np.asarray(np.minimum(far, np.maximum(h_body(a), growth * (away - a)).min(axis=1)))

    def walls(self, curves: Sequence[WallCurve]) -> list[Curve]:
        """The nodes on pieces of walls, whose tags follow the bodies'; all are placed together."""
        if not curves:
            return []
        wall = np.array([curve.wall for curve in curves])
        longest = np.array([curve.longest_element for curve in curves])
        fewest = np.array([float(curve.fewest_elements) for curve in curves])
        beside_bends = [
            Grading.beside_bends(curves, number, self.resolution) for number in range(int(wall.max()) + 1)
        ]

        def at(s: Array, k: Indices) -> Array:
            x = np.empty((len(s), 2))
            for j in np.unique(k).tolist():
                x[k == j] = curves[j].at(s[k == j])
            return x

        def bends(x: Array, k: Indices) -> Array:
            return np.asarray(self.container.bends(x)[np.arange(len(x)), wall[k]])

        def size(s: Array, k: Indices) -> Array:
            x = at(s, k)
            bend = bends(x, k)
            h = np.minimum(self.sizes(x, bend=bend), np.minimum(longest[k], self.resolution.on_body(bend)))
            h = np.asarray(np.minimum(h, self.grading.sizes(x)))
            for number, grading in enumerate(beside_bends):
                on = wall[k] == number
                h[on] = np.minimum(h[on], grading.sizes(x[on]))
            return h

        s, h, k = resolve_all(size, np.array([curve.interval for curve in curves]), PIECES)
        placed = spread_all(s, h, k, [list(self._facing(c, s[k == j])) for j, c in enumerate(curves)], fewest)
        of = np.repeat(np.arange(len(curves)), [len(places) for places in placed])
        x, last = at(np.concatenate(placed), of), np.cumsum([len(places) for places in placed])
        ends = np.array([curve.ends for curve in curves])
        x[np.append(0, last[:-1])], x[last - 1] = ends[:, 0], ends[:, 1]
        opening = self._opening(x, wall[of], bends(x, of))
        tags = (self.bodies + 1 + wall).tolist()
        after = last[:-1].tolist()
        chains = zip(curves, tags, parted(x, after), parted(opening, after), strict=True)
        return [Curve(tag, n, centre=c.centre, opening=o, body=c.solid) for c, tag, n, o in chains]

    def _opening(self, x: Array, wall: Indices, bend: Array) -> Array:
        """How far nodes x (n, 2) on walls, which bend so there, are moved into the solid while gmsh works."""
        if self.bodies == 0:
            return np.zeros_like(x)
        d, radius = self.nearest(x)
        half = 0.5 * self.resolution.opened(d, np.minimum(radius, bend))
        return -half[:, None] * self.container.normals(x)[np.arange(len(x)), wall]

    def _facing(self, curve: WallCurve, s: Array) -> Iterator[Array]:
        """The places of nodes on a wall that face those of the bodies in narrow gaps; s: samples along it."""
        if self.placed:
            return
        container, x = self.container, curve.at(s)
        centres = self.centres + (x[0] - self.lattice.wrapped(x[:1]))
        gaps, curvature = container.distances(centres)[:, curve.wall] - self.radii, self.curvature(curve.wall)
        for k in np.flatnonzero((gaps > 0.0) & (gaps < NARROW * self.radii)):
            centre, a = centres[k], float(self.radii[k])
            gap = FacedGap(float(gaps[k]), a, 1.0 / a + curvature)
            nearest = int(np.argmin(np.hypot(*(x - centre).T)))
            low, high = s[max(nearest - 1, 0)], s[min(nearest + 1, len(s) - 1)]
            foot = foot_on(curve, container, centre, 2.0 * low - high, 2.0 * high - low)
            if foot is not None:
                yield on_wall(curve, container, foot, gap.places(self.resolution.cells_per_gap))

    def curvature(self, wall: int) -> float:
        """Of a wall, negative where the fluid lies inside of it."""
        sphere = self.container.spheres[wall]
        return 0.0 if sphere is None else -self.container.concavities[wall] / sphere.radius

    def lines(self, at: Callable[[Array, Indices], Array], ends: Array, pieces: int) -> list[Array]:
        """Places s of nodes on lines `at(s, k)` through the fluid from surface to surface; ends (n, 2)."""
        if len(ends) == 0:
            return []
        length = ends[:, 1] - ends[:, 0]
        s, h, k = resolve_all(lambda s, k: self.sizes(at(s, k), length[k]), ends, pieces)
        at_once, of = equidistribute_all(s, 1.0 / h, k, np.ones(len(ends), dtype=np.int64))
        placed = parted(at_once, np.searchsorted(of, np.arange(1, len(ends))).tolist())
        for places, interval in zip(placed, ends, strict=True):
            places[[0, -1]] = interval
        return placed
