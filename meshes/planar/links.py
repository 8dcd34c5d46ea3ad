"""The straight ways between neighbouring surfaces where these are nearest to each other."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.meshes.errors import TouchingError
from fsi.meshes.geometry.feet import Foot
from fsi.meshes.geometry.lattice import positive
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.wall_feet import wall_feet
from fsi.meshes.planar.sizing import Surfaces


@dataclass(frozen=True, slots=True)
class NeighbourLinks:
    """Neighbours and the straight ways between them, n links.

    Attributes:
        first: where each begins: bodies 0 ... N - 1, then walls, (n,).
        second: where it ends, (n,).
        shift: the integers by which the image of `second` that is meant is moved, (n, k).
        step: from the centre of `first` to that of the image, (n, 2); a wall's centre is its nearest point.
        gap: between the two surfaces, (n,).
        along: its direction, (n, 2).
        feet: what lies from each centre to its end, besides the radius of a disc along it, (n, 2, 2).
        turns: the angles at which it leaves the two, around an outline 2 pi t, (n, 2).
    """

    first: Indices
    second: Indices
    shift: Indices
    step: Array
    gap: Array
    along: Array
    feet: Array
    turns: Array

    @staticmethod
    def straight(first: Indices, second: Indices, shift: Indices, step: Array, gap: Array) -> NeighbourLinks:
        """Links from centre to centre."""
        along = step / np.hypot(step[:, 0], step[:, 1])[:, None]
        turns = np.column_stack([np.arctan2(way[:, 1], way[:, 0]) for way in (step, -step)])
        return NeighbourLinks(first, second, shift, step, gap, along, np.zeros((len(gap), 2, 2)), turns)

    def __getitem__(self, chosen: NDArray[np.bool_] | Indices) -> NeighbourLinks:
        """Some of them."""
        return NeighbourLinks(*(getattr(self, field.name)[chosen] for field in fields(self)))

    def __len__(self) -> int:
        """How many."""
        return len(self.gap)


def neighbours(surfaces: Surfaces, reach: float) -> NeighbourLinks:
    """All links with gaps up to `reach` between bodies, and those of all bodies to the walls."""
    n, m, lattice = surfaces.bodies, surfaces.shifts, surfaces.lattice
    centres, radii = surfaces.centres[:n], surfaces.radii[:n]
    farthest = 2.0 * radii.max(initial=0.0) + reach
    first, image = surfaces.nearby.pairs(centres, farthest)
    which, second = np.divmod(image, max(n, 1))
    # Each link once: to a later body, or to the body's own image by the first of two opposite shifts.
    once = (second > first) | ((second == first) & positive(m[which]))
    first, second, shift = first[once], second[once], m[which[once]]
    step = centres[second] + lattice.shift(shift) - centres[first]
    gap = np.hypot(*step.T) - radii[first] - radii[second]
    between = NeighbourLinks.straight(first, second, shift, step, gap)[gap <= reach]
    if surfaces.placed:
        between, to_walls = outline_links(surfaces, between), outline_links_to_walls(surfaces)
        return joined(between[between.gap <= reach], to_walls)
    return joined(between, _to_walls(surfaces))


def _to_walls(surfaces: Surfaces) -> NeighbourLinks:
    """From each body straight to each wall; without bodies from the first wall to the second."""
    n, container = surfaces.bodies, surfaces.container
    centres, walls = surfaces.centres[:n] if n else np.zeros((1, 2)), len(container.walls)
    distances, normals = container.distances(centres), container.normals(centres)
    if n == 0:
        first, second, gap = np.array([0]), np.array([1]), distances.sum(axis=1)
        step = gap[:, None] * normals[0, :1]
    else:
        first, wall = np.divmod(np.arange(n * walls), max(walls, 1))
        step = distances[first, wall, None] * -normals[first, wall]
        second, gap = n + wall, distances[first, wall] - surfaces.radii[first]
    shift = np.zeros((len(first), surfaces.lattice.dimension), dtype=np.int64)
    return NeighbourLinks.straight(first, second, shift, step, gap)


@dataclass(frozen=True, slots=True, eq=False)
class LinkEnds:
    """Where a link ends on its two surfaces.

    Attributes:
        places: t on the first and on the second, 0 on a wall.
        feet: seen from the two centres, (2, 2); a wall's centre is its nearest point.
    """

    places: tuple[float, float]
    feet: Array


def outline_links(surfaces: Surfaces, near: NeighbourLinks) -> NeighbourLinks:
    """Those between the nearest points of outlines, in place of links between centres."""
    ends = []
    for i, j, step in zip(near.first, near.second, near.step, strict=True):
        body, other = surfaces.placed[i], surfaces.placed[j]
        other = other.moved(body.centre + step)
        foot = _apart(body, body.gap_to(other))
        t = body.outline.snapped(foot.t)
        s = other.outline.snapped(float(other.nearest(foot.opposite[None])[0]))
        x, y = (one.at(np.array([at])).x[0] - one.centre for one, at in ((body, t), (other, s)))
        ends.append(LinkEnds((t, s), np.array([x, y])))
    return _with_ends(near, ends)


def outline_links_to_walls(surfaces: Surfaces) -> NeighbourLinks:
    """From the nearest point of each outline straight to each wall, where there are bodies."""
    n, container = surfaces.bodies, surfaces.container
    walls, ends, steps = len(container.walls), [], []
    for body in surfaces.placed[:n]:
        for wall, foot in enumerate(wall_feet(body, container)):
            t = body.outline.snapped(_apart(body, foot).t)
            x = body.at(np.array([t])).x
            on_wall = x[0] - container.distances(x)[0, wall] * container.normals(x)[0, wall]
            ends.append(LinkEnds((t, 0.0), np.array([x[0] - body.centre, np.zeros(2)])))
            steps.append(on_wall - body.centre)
    first, of = np.divmod(np.arange(n * walls), max(walls, 1))
    shift, step = np.zeros((n * walls, surfaces.lattice.dimension), np.int64), np.array(steps).reshape(-1, 2)
    links = NeighbourLinks.straight(first, n + of, shift, step, np.zeros(n * walls))
    return _with_ends(links, ends)


def _apart(body: Placed, foot: Foot) -> Foot:
    """A gap that is one. Raises TouchingError."""
    if foot.gap <= 0.0:
        raise TouchingError("the body at {} touches a body or wall, or overlaps it; move it", body.centre)
    return foot


def _with_ends(links: NeighbourLinks, ends: list[LinkEnds]) -> NeighbourLinks:
    """The same links with other ends."""
    if not ends:
        return links
    feet = np.array([end.feet for end in ends])
    way = feet[:, 1] + links.step - feet[:, 0]
    gap = np.hypot(way[:, 0], way[:, 1])
    turns = 2.0 * np.pi * np.array([end.places for end in ends])
    return replace(links, gap=gap, along=way / gap[:, None], feet=feet, turns=turns)


def joined(*parts: NeighbourLinks) -> NeighbourLinks:
    """All links of the parts."""
    names = [field.name for field in fields(NeighbourLinks)]
    return NeighbourLinks(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))
