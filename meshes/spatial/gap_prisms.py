"""The narrow part of a gap: one layer of prisms, each split in three tetrahedra.

The layer fills what a cylinder around the line of the shortest distance cuts out of a gap. Its cells, longer
than the gap is wide, stand between two triangulations of the same pattern, one on either surface: so they are
valid and alike however narrow the gap is, where free tetrahedra would be slivers. The cylinder ends where
the gap is as wide as its elements are long.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array, Indices
from fsi.meshes.geometry.container import FluidDomain, lengths
from fsi.meshes.planar.spread import equidistribute
from fsi.meshes.spatial.sizing import Spacing

WIDEST = 0.5  # radius of a layer, in radii of the smaller body
CLEARANCE = 0.35  # radius of a layer over the distance to what else is there
ROW = 0.5 * np.sqrt(3.0)  # height of an equilateral triangle
FEWEST_ON_EDGE = 8
SAMPLES = 400


@dataclass(frozen=True, slots=True)
class NarrowGap:
    """A body and the surface that faces it, another body or a wall, both round about the axis `along`.

    The other surface lies `height + bend sqrt(curvature_radius^2 - rho^2)` above the centre of the body, at
    the distance rho from the axis.

    Attributes:
        tags: of the two surfaces.
        centre: of the body, (3,).
        radius: of the body.
        along: unit vector towards the other surface, (3,).
        height: see above.
        bend: 0 for a flat wall, -1 for a surface that bends away from the body, 1 for one around it.
        curvature_radius: of the other surface.
        smallest: radius of the smaller body.
    """

    tags: tuple[int, int]
    centre: Array
    radius: float
    along: Array
    height: float
    bend: float
    curvature_radius: float
    smallest: float

    def heights(self, rho: Array | float) -> tuple[Array, Array]:
        """Of both surfaces above the body's centre at the distance rho from the axis."""
        below = np.sqrt(self.radius**2 - np.square(rho))
        above = self.height + self.bend * np.sqrt(self.curvature_radius**2 - np.square(rho))
        return below, above

    def width(self, rho: Array | float) -> Array:
        """Of the gap, along the axis."""
        below, above = self.heights(rho)
        return above - below

    def middle(self) -> Array:
        """The point half-way between the surfaces."""
        below, above = self.heights(0.0)
        return self.centre + 0.5 * (below + above) * self.along

    def frame(self) -> tuple[Array, Array]:
        """Two unit vectors across the axis; with it they are right-handed."""
        first = np.cross(self.along, np.eye(3)[np.argmin(np.abs(self.along))])
        first /= np.linalg.norm(first)
        return first, np.cross(self.along, first)

    def places(self, y: Array, side: int) -> Array:
        """Points of a surface (0: the body, 1: the other) at places y (n, 2) across the axis."""
        first, second = self.frame()
        height = np.broadcast_to(self.heights(lengths(y))[side], len(y))
        x: Array = self.centre + y[:, :1] * first + y[:, 1:] * second + height[:, None] * self.along
        return x


@dataclass(frozen=True, slots=True)
class GapPrisms:
    """The layer of prisms that fills a gap up to the radius `rho`, with `on_edge` nodes on either edge."""

    gap: NarrowGap
    rho: float
    on_edge: int


def find_gaps(spacing: Spacing) -> list[NarrowGap]:
    """All gaps narrower than the elements there would be long, where both surfaces are round about them.

    Raises MeshError where surfaces touch.
    """
    gaps, centres, radii = [], spacing.domain.centres, spacing.domain.radii
    for pair in (pair for pair in spacing.close_pairs() if pair.layered):
        i, j = pair.body, pair.other
        if j >= len(radii):
            gaps.append(_to_wall(spacing.domain, i, j - len(radii)))
            continue
        apart = centres[j] - centres[i]
        away, a, b = float(np.linalg.norm(apart)), float(radii[i]), float(radii[j])
        tags = (i + 1, j + 1)
        gaps.append(NarrowGap(tags, centres[i], a, apart / away, away, -1.0, b, pair.smallest))
    return [gap for gap in gaps if gap.width(0.0) < spacing.in_gap(gap.width(0.0), gap.smallest)]


def _to_wall(domain: FluidDomain, i: int, k: int) -> NarrowGap:
    centre, a, container = domain.centres[i], float(domain.radii[i]), domain.container
    distance = float(container.distances(centre[None])[0, k])
    tags, sphere = (i + 1, len(domain.radii) + 1 + k), container.spheres[k]
    if sphere is None:
        return NarrowGap(tags, centre, a, -container.normals(centre[None])[0, k], distance, 0.0, a, a)
    from_centre = centre - sphere.centre
    off = float(np.linalg.norm(from_centre))
    along = from_centre / off if off > 0.0 else np.array([0.0, 0.0, 1.0])
    return NarrowGap(tags, centre, a, along, -off, 1.0, off + distance, a)


def choose(gaps: Sequence[NarrowGap], spacing: Spacing) -> list[GapPrisms]:
    """The layers of those gaps that have room for one."""
    domain = spacing.domain
    middles = np.array([gap.middle() for gap in gaps]).reshape(-1, 3)
    layers = []
    for k, gap in enumerate(gaps):
        others = np.arange(1, len(domain.radii) + 1)
        to_bodies = lengths(domain.centres - middles[k]) - domain.radii
        to_walls = domain.container.distances(middles[k : k + 1])[0]
        walls = len(others) + 1 + np.arange(len(to_walls))
        clear = np.concatenate([to_bodies[~np.isin(others, gap.tags)], to_walls[~np.isin(walls, gap.tags)]])
        to_middles = np.delete(lengths(middles - middles[k]), k)
        room = min(part.min(initial=np.inf) for part in (clear, to_middles, spacing.to_sides(middles[[k]])))
        if room <= 0.0:
            continue
        layer = _layer(gap, spacing, min(WIDEST * gap.smallest, CLEARANCE * room))
        if layer is not None:
            layers.append(layer)
    return layers


def _layer(gap: NarrowGap, spacing: Spacing, widest: float) -> GapPrisms | None:
    """As wide as the elements are longer than the gap, and at most `widest`; None if that is one element."""

    def excess(rho: float) -> float:
        return float(gap.width(rho) - spacing.in_gap(gap.width(rho), gap.smallest))

    rho = widest if excess(widest) < 0.0 else float(scipy.optimize.brentq(excess, 0.0, widest, rtol=1e-6))
    size = float(spacing.in_gap(gap.width(rho), gap.smallest))
    if rho < size:
        return None
    return GapPrisms(gap, rho, 4 * max(FEWEST_ON_EDGE // 4, round(0.5 * np.pi * rho / size)))


def pattern(layer: GapPrisms, spacing: Spacing) -> tuple[Array, Indices]:
    """Places across the axis, inner ones (n, 2) before the edge's, and the triangles between them.

    The places stand in rings, each turned by half an element against the next.
    """
    s = np.linspace(0.0, layer.rho, SAMPLES)
    size = spacing.in_gap(layer.gap.width(s), layer.gap.smallest)
    rings = equidistribute(s, 1.0 / (ROW * size), least=1)
    rows = [np.zeros((1, 2))]
    for k, rho in enumerate(rings[1:], start=1):
        last = k == len(rings) - 1
        count = layer.on_edge if last else max(5, round(2.0 * np.pi * rho / float(np.interp(rho, s, size))))
        turn = 0.5 * ((len(rings) - 1 - k) % 2)
        angle = 2.0 * np.pi * (np.arange(count) + turn) / count
        rows.append(rho * np.column_stack([np.cos(angle), np.sin(angle)]))
    y = np.concatenate(rows)
    return y, scipy.spatial.Delaunay(y).simplices.astype(np.int64)


def split_prisms(triangles: Indices, below: Indices, above: Indices, backwards: Indices) -> Indices:
    """Three tetrahedra for each prism over a triangle (a, b, c) of places.

    On the side over places u < v the diagonal goes from `below[u]` to `above[v]`; over the pairs of edge
    places in `backwards` (m, 2), sorted, it goes from `below[v]` to `above[u]`. A prism has one side on the
    edge at most, and its third place is an inner one, which comes first: no three diagonals run in a circle.
    """
    v = np.sort(triangles, axis=1)
    n = int(v.max()) + 1
    turned = np.isin(v[:, 1] * n + v[:, 2], backwards @ [n, 1])
    v[turned] = v[turned][:, [0, 2, 1]]
    low, high = below[v], above[v]
    return np.concatenate([np.column_stack([low[:, : 3 - k], high[:, 2 - k :]]) for k in range(3)])
