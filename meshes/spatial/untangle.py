"""Move vertices so that curved cells become valid.

A facet bulges from its plane by h^2 / 6 a, of elements of size h on a sphere of radius a. gmsh knows of
straight cells alone: a flat one over a facet, good enough as it is, turns over when it is curved. To mesh
again with smaller elements costs more than all else, and most cells were good. So the vertices of bad cells
are moved, away from the opposite side, towards the middle of their neighbours or along an axis, where that
makes the worst of the cells around them better and none of them flat, which the scaled Jacobian does not see
and the iterative solver suffers from. Those on one sphere or ellipsoid stay on it, those on
walls and sides stay where they are; a mesh without bad cells is left as it is.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import batched

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.meshes.cells.curved import WORST_ACCEPTED, CurvedCells, scaled_jacobian
from fsi.meshes.geometry.container import lengths
from fsi.meshes.planar.triangulate import StraightCells
from fsi.meshes.spatial.curved_tetrahedra import RoundSurface, bent_cells, curve_tets, curved_places, joined

WANTED = 2.0 * WORST_ACCEPTED  # of the cells of a mesh that is mended at all
SWEEPS = 20
# Steps over the longest edge of the opposite side; over the whole way to the middle; over that edge, on axes.
AWAY, MIDDLE, ALONG = (0.05, 0.1, 0.2, 0.35), (0.25, 0.5, 1.0), (-0.15, -0.05, 0.05, 0.15)
FLATTEST = 0.04  # height of a cell that is moved, over that of a regular one; flatter ones get no flatter
MOST = 0.02  # of all cells: with more bad ones a mesh is too coarse, and is not mended
AT_ONCE = 20_000  # cells that are tried together: calls of NumPy take longer than the few around bad ones


def curved_and_valid(straight: StraightCells, spheres: Mapping[int, RoundSurface], order: int) -> CurvedCells:
    """`curve_tets`, with vertices moved where cells would not be valid, as far as that helps."""
    x, bent = curved_places(straight, spheres, order), bent_cells(straight, spheres)
    quality = np.ones(len(straight.cells))
    quality[bent] = scaled_jacobian(x[bent], order)
    if not 0 < np.sum(quality <= WORST_ACCEPTED) <= MOST * len(quality):
        return joined(straight, x, order)
    tangle, vertices, idle = _Tangle(straight, spheres, order), straight.vertices.copy(), 0
    for _ in range(SWEEPS):
        bad = np.flatnonzero(quality <= WANTED)
        movable = tangle.apart(bad[np.argsort(quality[bad])])
        idle = 0 if len(movable) and _moved(tangle, vertices, quality, movable) else idle + 1
        if idle == 4:  # each of the vertices of a cell has come first
            break
    return curve_tets(replace(straight, vertices=vertices), spheres, order)


@dataclass(frozen=True, slots=True)
class _Movable:
    """A vertex, the bad cell that it is moved for, and all cells around it."""

    vertex: int
    cell: int
    around: Indices


class _Tangle:
    """Cells whose vertices move."""

    def __init__(self, straight: StraightCells, spheres: Mapping[int, RoundSurface], order: int) -> None:
        """What only vertices that move need is found when the first does."""
        self.straight, self._spheres, self._order, self._tried = straight, spheres, order, 0
        self._round = np.isin(straight.tags, list(spheres))

    @cached_property
    def _surface(self) -> Indices:
        """The tag of the one surface that a vertex is on; 0: inside, -1: on several."""
        n, mesh = len(self.straight.vertices), self.straight
        low, high = np.full(n, np.iinfo(np.int64).max), np.zeros(n, dtype=np.int64)
        corners, tags = mesh.facets.ravel(), np.repeat(mesh.tags, 3)
        np.minimum.at(low, corners, tags)
        np.maximum.at(high, corners, tags)
        return np.where((low == high) | (high == 0), high, -1)

    @cached_property
    def _movable(self) -> NDArray[np.bool_]:
        movable: NDArray[np.bool_] = (self._surface == 0) | np.isin(self._surface, list(self._spheres))
        return movable

    @cached_property
    def _by_vertex(self) -> tuple[Indices, Indices]:
        """The cells of all vertices, and where those of each begin."""
        corners = self.straight.cells.ravel()
        order = np.argsort(corners, kind="stable")
        return order // 4, np.searchsorted(corners[order], np.arange(len(self.straight.vertices) + 1))

    @cached_property
    def _least(self) -> Array:
        """How flat each cell may become."""
        return np.minimum(_shape(self.straight.vertices[self.straight.cells]), FLATTEST)

    def around(self, vertex: int) -> Indices:
        """The cells of a vertex."""
        cells, first = self._by_vertex
        return cells[first[vertex] : first[vertex + 1]]

    def quality(self, vertices: Array, some: Indices) -> Array:
        """Scaled Jacobians of some cells, with the vertices (n, 3) where they are now."""
        used, part = self._part(vertices, some)
        return self._quality_of(part, vertices[None, used]).ravel()

    def tried(self, vertices: Array, some: Indices, moving: Indices, places: Array) -> Array:
        """The same with these vertices at places (k, m, 3), (k, some); -1 of cells that become too flat."""
        used, part = self._part(vertices, some)
        tried = np.repeat(vertices[None, used], len(places), axis=0)
        tried[:, np.searchsorted(used, moving)] = places
        flatter = _shape(tried[:, part.cells].reshape(-1, 4, 3)).reshape(len(places), -1) < self._least[some]
        return np.where(flatter, -1.0, self._quality_of(part, tried))

    def _part(self, vertices: Array, some: Indices) -> tuple[Indices, StraightCells]:
        """The vertices of some cells and of the facets near them, and these, numbered among them."""
        here, mesh = np.zeros(len(vertices), dtype=bool), self.straight
        here[mesh.cells[some]] = True
        near = self._round & (here[mesh.facets].sum(axis=1) >= 2)
        here[mesh.facets[near]] = True
        number, used = np.cumsum(here) - 1, np.flatnonzero(here)
        cells, facets = number[mesh.cells[some]], number[mesh.facets[near]]
        return used, StraightCells(vertices[used], cells, facets, mesh.tags[near])

    def _quality_of(self, part: StraightCells, places: Array) -> Array:
        """Scaled Jacobians of copies of a part, each with its vertices elsewhere, (k, n, 3); (k, cells)."""
        copies, n = places.shape[:2]
        first = n * np.arange(copies)[:, None, None]
        cells, facets = (part.cells + first).reshape(-1, 4), (part.facets + first).reshape(-1, 3)
        every = StraightCells(places.reshape(-1, 3), cells, facets, np.tile(part.tags, copies))
        x = curved_places(every, self._spheres, self._order)
        return scaled_jacobian(x, self._order).reshape(copies, -1)

    def apart(self, bad: Indices) -> list[_Movable]:
        """Vertices of these cells that may move, the worst cells first, no two of one cell.

        Of the vertices of a cell another one comes first in each call.
        """
        taken, chosen = np.zeros(len(self.straight.cells), dtype=bool), list[_Movable]()
        for cell in bad.tolist():
            corners = np.roll(self.straight.cells[cell], self._tried)
            for vertex in corners[self._movable[corners]].tolist():
                around = self.around(vertex)
                if not taken[around].any():
                    taken[around] = True
                    chosen.append(_Movable(vertex, cell, around))
                    break
        self._tried += 1
        return chosen

    def steps(self, vertices: Array, movable: list[_Movable]) -> Iterator[Array]:
        """How far each vertex could move, (m, 3)."""
        mesh, moving = self.straight, np.array([each.vertex for each in movable])
        corners = mesh.cells[[each.cell for each in movable]]
        others = corners[corners != moving[:, None]].reshape(-1, 3)
        a, b, c = (vertices[others[:, k]] for k in range(3))
        normal: Array = np.cross(b - a, c - a)
        normal /= lengths(normal)[:, None]
        normal *= np.copysign(1.0, np.einsum("md,md->m", vertices[moving] - a, normal))[:, None]
        edges = np.column_stack([lengths(b - a), lengths(c - b), lengths(a - c)])
        longest = edges.max(axis=1)[:, None]
        middles = [
            vertices[np.setdiff1d(mesh.cells[each.around], each.vertex)].mean(axis=0) for each in movable
        ]
        yield from (step * longest * normal for step in AWAY)
        yield from (step * (np.array(middles) - vertices[moving]) for step in MIDDLE)
        yield from (step * longest * axis for step in ALONG for axis in np.eye(3))

    def on_surfaces(self, moving: Indices, x: Array) -> Array:
        """Places x (k, m, 3) of these vertices, those on a sphere put back on it."""
        placed, surface = x.copy(), self._surface[moving]
        for tag in np.unique(surface[surface > 0]).tolist():
            on = x[:, surface == tag]
            placed[:, surface == tag] = self._spheres[tag].project(on.reshape(-1, 3)).reshape(on.shape)
        return placed


def _moved(tangle: _Tangle, vertices: Array, quality: Array, movable: list[_Movable]) -> bool:
    """Move each of these vertices where it is best, and tell whether any was; the arrays are changed."""
    moving = np.array([each.vertex for each in movable])
    some = np.concatenate([each.around for each in movable])
    starts = np.cumsum([0, *(len(each.around) for each in movable[:-1])])
    best, place = np.minimum.reduceat(quality[some], starts), vertices[moving].copy()
    for steps in batched(tangle.steps(vertices, movable), max(1, AT_ONCE // len(some))):
        places = tangle.on_surfaces(moving, vertices[moving] + np.array(steps))
        tried = tangle.tried(vertices, some, moving, places)
        for there, worst in zip(places, np.minimum.reduceat(tried, starts, axis=1), strict=True):
            better: NDArray[np.bool_] = worst > best + 1e-3
            best, place = np.maximum(best, worst), np.where(better[:, None], there, place)
    changed = bool(np.any(place != vertices[moving]))
    vertices[moving] = place
    quality[some] = tangle.quality(vertices, some)
    return changed


def _shape(x: Array) -> Array:
    """Volume of tetrahedra (n, 4, 3) over that of a regular one with their longest edge."""
    edges = np.stack([x[:, i] - x[:, j] for i in range(4) for j in range(i)], axis=1)
    longest = np.sqrt((edges**2).sum(axis=2).max(axis=1))
    shape: Array = np.abs(np.linalg.det(x[:, 1:] - x[:, :1])) * np.sqrt(2.0) / longest**3
    return shape
