"""Where a periodic domain in space is opened: along plane sides that meet spheres and gaps well, or not.

A cell without walls is opened as the parallelepiped of its periods, a layer between two walls as a prism on
the parallelogram of its two. Any origin is right, so that it stands where its sides lie well. In coordinates
c_k along the periods the side k is the plane c_k = s_k, and a sphere of radius a around q the interval
c_k(q) -+ a |b_k|, with the gradient b_k of c_k. A side that nearly touches a sphere, from without or within,
leaves slivers; one that crosses the middle of a narrow gap leaves no room for its prisms. So of all s_k in
[0, 1) that is taken which is farthest from all ends of intervals and from all narrow gaps. The lines in
which two sides meet, and the corners, must neither touch a sphere nearly, as that leaves facets with all
their vertices on sides: where one does, the origin is chosen again from places that are good for each side.

Spheres that stand in several places are several surfaces of one body, and each of their images that meets the
cell is cut out of it. gmsh copies the triangles of one side to the opposite one. Edges and facets on a sphere
bend about its own centre, so that curved cells match as straight ones do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import Any

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrays import Array, Indices
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.lattice import Lattice

PLACES = 400  # that are tried for each side
FEW = 20  # of them that are tried together with those of the other sides
FAR = 0.3  # of a radius: no distance of a side from a sphere is better than this
NEAR = 0.15  # of a radius: a line where sides meet that is nearer is moved
REMEDY = "lower discretisation.growth or raise cells_per_circle"
SAME = 1e-6  # in periods: faces nearer to a side lie in it, and such that differ by it match


@dataclass(frozen=True, slots=True)
class Sides:
    """The parallelepiped `origin + c @ edges`, c in [0, 1]^3, periodic along the first `periods` edges."""

    origin: Array
    edges: Array
    periods: int

    def coordinates(self, x: Array) -> Array:
        """c of points (n, 3)."""
        c: Array = (x - self.origin) @ np.linalg.inv(self.edges)
        return c

    @property
    def widths(self) -> Array:
        """Distances of opposite faces, (3,)."""
        widths: Array = 1.0 / np.linalg.norm(np.linalg.inv(self.edges), axis=0)
        return widths

    def moved(self, aside: float) -> Sides:
        """The same, the first side so far on along its edge, each other one a little farther."""
        along = self.edges[: self.periods] / np.linalg.norm(self.edges[: self.periods], axis=1)[:, None]
        return replace(self, origin=self.origin + aside * (1.0 + 0.3 * np.arange(self.periods)) @ along)

    def distances(self, x: Array) -> Array:
        """Of points (n, 3) from the periodic sides, low and high ones, (n, 2 periods); positive inside."""
        c, k = self.coordinates(x), slice(self.periods)
        return np.hstack([c[:, k] * self.widths[k], (1.0 - c[:, k]) * self.widths[k]])

    def solid(self, kernel: Any) -> int:
        """The inside as a solid of gmsh's kernel (`gmsh.model.occ`): its number."""
        corners = [tuple(m) for m in product((0, 1), repeat=3)]
        points = {m: kernel.addPoint(*(self.origin + np.array(m) @ self.edges)) for m in corners}
        lines = {
            (m, n): kernel.addLine(points[m], points[n])
            for m, n in combinations(corners, 2)
            if np.abs(np.subtract(m, n)).sum() == 1
        }
        faces = []
        for k, side in product(range(3), (0, 1)):
            around = [(*m[:k], side, *m[k:]) for m in ((0, 0), (0, 1), (1, 1), (1, 0))]
            along = zip(around, [*around[1:], around[0]], strict=True)
            loop = [lines[pair] if pair in lines else -lines[pair[::-1]] for pair in along]
            faces.append(kernel.addPlaneSurface([kernel.addCurveLoop(loop)]))
        return int(kernel.addVolume([kernel.addSurfaceLoop(faces)]))

    def tie(self, model: Any) -> list[int]:
        """Tell gmsh which faces of its model are images of which; returns the faces on all periodic sides."""
        faces = [face for _, face in model.getEntities(2) if model.getType(2, face) == "Plane"]
        middles = np.array([model.occ.getCenterOfMass(2, face) for face in faces]).reshape(-1, 3)
        c, tied = self.coordinates(middles), list[int]()
        for k, period in enumerate(np.eye(3)[: self.periods]):
            low, high = (np.flatnonzero(np.abs(c[:, k] - side) < SAME) for side in (0.0, 1.0))
            away = np.abs(c[low, None] + period - c[high]).max(axis=2)
            if away.shape[0] != away.shape[1] or away.min(axis=1, initial=0.0).max(initial=0.0) > SAME:
                raise MeshError(
                    "gmsh cut opposite sides of a cell in different ways; shift all bodies a little"
                )
            for master, slave in zip(low, high[away.argmin(axis=1)], strict=True):
                shift = np.eye(4)
                shift[:3, 3] = self.edges[k]
                model.mesh.setPeriodic(2, [faces[slave]], [faces[master]], shift.ravel().tolist())
                tied += [faces[master], faces[slave]]
        return tied

    def matched(self, vertices: Array, on_sides: Indices) -> Array:
        """The vertices (n, 3) with those of high sides where their images on low ones are, to the last bit.

        on_sides: numbers of the vertices on all sides. Where curves meet, the kernel of gmsh has its own
        places for either side, and these differ by its tolerance. Raises MeshError: sides do not match.
        """
        x = vertices.copy()
        c = self.coordinates(x[on_sides])
        for k in range(self.periods):
            low, high = (on_sides[np.abs(c[:, k] - side) < SAME] for side in (0.0, 1.0))
            off, image = scipy.spatial.cKDTree(x[low] + self.edges[k]).query(x[high])
            if len(low) != len(high) or off.max(initial=0.0) > SAME * self.widths[k]:
                raise MeshError(
                    "gmsh meshed opposite sides of a cell in different ways; shift all bodies a little"
                )
            x[high] = x[low[image]] + self.edges[k]
        return x


def frame(container: Container) -> tuple[Array, Array]:
    """A corner and the edges of a parallelepiped that a periodic container fills, (3,) and (3, 3)."""
    periods = container.periods
    if len(periods) == 3:
        return np.zeros(3), periods
    here = np.zeros((1, 3))
    (below, above), upwards = container.distances(here)[0], container.normals(here)[0, 0]
    return -below * upwards, np.vstack([periods, (below + above) * upwards])


def choose_sides(domain: FluidDomain, middles: Array, radii: Array) -> Sides:
    """Those that lie best between the spheres of a domain and its narrow gaps.

    middles: of the gaps, any images, (g, 3); radii: of what a side should not cross there, (g,).
    """
    corner, edges = frame(domain.container)
    sides, k = Sides(corner, edges, len(domain.container.periods)), len(domain.container.periods)
    c, of_gaps, widths = sides.coordinates(domain.centres), sides.coordinates(middles), sides.widths
    s = np.arange(PLACES) / PLACES
    best, scores = np.zeros(3), np.empty((k, PLACES))
    for axis in range(k):
        to_centres = np.abs(_between(c[:, axis], s)) * widths[axis]
        to_spheres = np.abs(to_centres - domain.radii) / domain.radii
        to_gaps = np.abs(_between(of_gaps[:, axis], s)) * widths[axis] / radii
        spoilt = np.maximum(0.0, 1.0 - to_gaps).sum(axis=1)
        score = np.minimum(to_spheres.min(axis=1, initial=FAR), FAR) - FAR * spoilt / max(len(radii), 1)
        # In the middle of where it is as good, so that no side is near to where it would be worse.
        best[axis], scores[axis] = s[_middle_of_best(score)], score
    here = [np.array([place]) for place in best[:k]]
    if clear_where_sides_meet(sides, domain, here).min(initial=FAR) < NEAR:
        best[:k] = _chosen_together(sides, domain, s, scores)
    return Sides(corner + best @ edges, edges, k)


def _chosen_together(sides: Sides, domain: FluidDomain, s: Array, scores: Array) -> Array:
    """The places of all sides, (k,), with the greatest least of all scores; those of each are (k, places)."""
    good = [np.flatnonzero(score >= score.max() - 0.5 * FAR) for score in scores]
    few = [some[np.linspace(0, len(some) - 1, min(FEW, len(some))).astype(int)] for some in good]
    every = clear_where_sides_meet(sides, domain, [s[some] for some in few])
    for score in np.meshgrid(*(scores[axis][some] for axis, some in enumerate(few)), indexing="ij"):
        every = np.minimum(every, score)
    chosen = np.unravel_index(int(every.argmax()), every.shape)
    return np.array([s[some[i]] for some, i in zip(few, chosen, strict=True)])


def clear_where_sides_meet(sides: Sides, domain: FluidDomain, places: Sequence[Array]) -> Array:
    """How far lines where two sides meet, and corners, are from the nearest sphere, over its radius.

    places: of each side, (m_k,); gives that of each choice, (m_0, m_1, ...).
    """
    k, c = sides.periods, sides.coordinates(domain.centres)
    clear = np.full([len(s) for s in places], np.inf)
    for meeting in (some for number in range(2, k + 1) for some in combinations(range(k), number)):
        shape = [len(places[axis]) if axis in meeting else 1 for axis in range(k)]
        grid = np.meshgrid(*(places[axis] for axis in meeting), indexing="ij")
        between = np.stack(
            [c[:, axis] - s[..., None] for axis, s in zip(meeting, grid, strict=True)], axis=-1
        )
        between -= np.rint(between)
        across = sides.edges[list(meeting)]
        for along in (sides.edges[axis] for axis in range(3) if len(meeting) == 2 and axis not in meeting):
            across = across - np.outer(across @ along, along) / (along @ along)
        for image in product((-1.0, 0.0, 1.0), repeat=len(meeting)):
            away = np.linalg.norm((between + image) @ across, axis=-1)
            off = (np.abs(away - domain.radii) / domain.radii).min(axis=-1, initial=np.inf)
            clear = np.minimum(clear, off.reshape(shape))
    return clear


def _between(c: Array, s: Array) -> Array:
    """Differences of coordinates from sides, those of the nearest images, (sides, n)."""
    apart = c - s[:, None]
    nearest: Array = apart - np.rint(apart)
    return nearest


def _middle_of_best(score: Array) -> int:
    """The middle of the longest run of places, on a circle, whose score is the best but for a tenth."""
    good = score >= score.max() - 0.1 * FAR
    if good.all():
        return 0
    start = int(np.flatnonzero(~good)[0])
    turned = np.roll(good, -start)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], turned, [False]])))
    runs = edges.reshape(-1, 2)
    low, high = runs[np.argmax(np.diff(runs, axis=1)[:, 0])]
    return int((start + (low + high) // 2) % len(score))


def images(domain: FluidDomain, sides: Sides, reach: float) -> tuple[FluidDomain, Indices]:
    """The domain with all images of its spheres that come as near as `reach` to the cell, and whose they are.

    The images of one sphere are spheres of their own there, (g,) in all.
    """
    k, lattice = sides.periods, Lattice(sides.edges[: sides.periods])
    c = sides.coordinates(domain.centres)[:, :k]
    home = domain.centres - lattice.shift(np.floor(c).astype(np.int64))
    farthest = (float(domain.radii.max(initial=0.0)) + reach) / sides.widths[:k]
    steps = [range(-n, n + 1) for n in np.ceil(farthest).astype(int).tolist()]
    every = np.array(list(product(*steps)), dtype=np.int64).reshape(-1, k)
    centres = (home[:, None] + lattice.shift(every)).reshape(-1, 3)
    of = np.repeat(np.arange(len(home)), len(every))
    radii = domain.radii[of]
    near = np.all(sides.distances(centres) >= -(radii + reach)[:, None], axis=1)
    opened = FluidDomain(domain.container, centres[near], radii[near], domain.corners, domain.edges)
    return opened, of[near]


def with_bodies(tags: Indices, of: Sequence[int] | Indices, bodies: int) -> Indices:
    """Tags of bodies, walls and sides from those of the images, whose bodies are `of`."""
    numbers = np.asarray(of, dtype=np.int64)
    rest = tags - len(numbers) + bodies
    on_image = (tags >= 1) & (tags <= len(numbers))
    found = rest.copy()
    found[on_image] = numbers[tags[on_image] - 1] + 1
    return found
