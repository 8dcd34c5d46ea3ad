"""Pores: the fluid between discs, cut along necks.

A neck is the shortest segment between two surfaces: of two discs on their line of centres, of a disc and a
wall on the wall's normal, of a disc and a container around it on their line of centres, on the near side. It
is perpendicular to both. A pore lies between three necks and three pieces of surfaces.

Why the pores tile the fluid. They are made of a few first pores by two operations alone, which keep each
side between two pores: a disc is put into a pore, which becomes three, and the common side of two pores is
flipped. Each pore is, with the sectors of its discs between its necks, a triangle of centres (beside a wall
the trapezium down to the feet of its necks, in a corner of a box a rectangle, in a container a sector's part
outside a chord), and `turn` > 0 says that it is run through anticlockwise. Going around a disc, its pores
follow each other by their common sides. So all of them form a surface without seams, which is laid on the
container (cell, channel) locally one to one; such a map is a covering, and it is of one sheet, since the
pores are as many as Euler's formula gives for N discs and their areas add up to the container's. Inside a
triangle the three necks do not meet, being on its sides, and the discs do not reach beyond theirs into a neck
if the disc opposite each neck is clear of it (`clearance` > 0), which is what is checked last. Then what a
triangle has besides its three sectors is its pore, and no disc but these three reaches into it: to come from
outside it would have to cross a neck.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.machine.compiled import compiled
from fsi.pores.links import Links, corner, turn
from fsi.pores.power import insert
from fsi.pores.shape import improve, narrowest
from fsi.pores.start import first_pores, order_of_insertion
from fsi.pores.surfaces import CONTAINER, DISC, WALL, Bodies, BoundingSurfaces, NoPoresError, Shapes


@dataclass(frozen=True, slots=True, eq=False)
class Pores:
    """K necks and E pores between surfaces.

    The image (m, n) of a surface is that translated by m and n periods; walls and containers, and periods
    that are missing, have 0. A pore's first disc (that of the least number) is in its base place.

    Attributes:
        surfaces: what bounds the fluid.
        necks: the two surfaces of a neck; a disc comes before a wall, of discs the lesser number, (K, 2).
        neck_image: the image of the second surface, seen from the first in its base place, (K, 2).
        neck_gap: length of the neck, > 0, (K,).
        vertices: the surfaces of a pore, anticlockwise, (E, 3).
        image: their images, (E, 3, 2).
        sides: the neck opposite vertex v, between vertices v + 1 and v + 2 (mod 3); -1 opposite the disc in
            the corner of a box, (E, 3).
    """

    surfaces: BoundingSurfaces
    necks: Bodies
    neck_image: Bodies
    neck_gap: Array
    vertices: Bodies
    image: Bodies
    sides: Bodies

    def __len__(self) -> int:
        """Number of pores E."""
        return len(self.vertices)


def triangulate(surfaces: BoundingSurfaces) -> Pores:
    """The pores between surfaces.

    They depend on the places of the discs alone, and on their order only where two choices are equal.

    Raises NoPoresError where bodies overlap, or where a body lies across a neck that cannot be flipped; both
    name the bodies. Fluid discs help against the latter, and where discs do not surround the centre of a
    round container.
    """
    return pores_of(surfaces, linked(surfaces))


def pores_of(surfaces: BoundingSurfaces, links: Links) -> Pores:
    """The same of pores that are linked already. Raises NoPoresError."""
    pores = numbered(surfaces, links)
    _require_gaps(pores)
    _require_clear_necks(surfaces, links)
    return begun_alike(pores)


def begun_alike(pores: Pores) -> Pores:
    """The pores, each run through from a vertex that its shape decides.

    Fluid discs come first, so that few patterns of them occur; else the vertex opposite the narrowest neck.
    Necks that differ by rounding alone are as wide, in whatever unit: circles of fluid often leave such.
    """
    gap = np.where(pores.sides < 0, 0.0, pores.neck_gap[pores.sides])
    gap = np.round(gap / gap.max(axis=1, keepdims=True), 9)
    fluid = pores.surfaces.fluid[pores.vertices].astype(np.int64)
    # Of bodies alone, and of fluid discs alone, all three vertices begin the same pattern.
    pattern = 4 * fluid + 2 * np.roll(fluid, -1, axis=1) + np.roll(fluid, -2, axis=1)
    most = pattern == pattern.max(axis=1, keepdims=True)
    start = np.where(most, gap, np.inf).argmin(axis=1)
    turned = (start[:, None] + np.arange(3)) % 3
    return replace(
        pores,
        vertices=np.take_along_axis(pores.vertices, turned, axis=1),
        image=np.take_along_axis(pores.image, turned[..., None], axis=1),
        sides=np.take_along_axis(pores.sides, turned, axis=1),
    )


def linked(surfaces: BoundingSurfaces) -> Links:
    """The pores and how they hang together: the power triangulation, improved."""
    discs, shapes = order_of_insertion(surfaces), surfaces.shapes()
    if len(discs) == 0:
        raise NoPoresError("there is no disc")
    links, rest = first_pores(surfaces, discs[:, 0])
    to_come = discs[np.isin(discs[:, 0], rest)]
    insert(shapes, links, len(links.body) - 2 * len(rest), to_come, np.full(len(to_come), -1))
    improve(shapes, links, np.ones(len(links.body), bool))
    return links


def with_more_discs(
    surfaces: BoundingSurfaces, links: Links, near: Bodies
) -> tuple[Links, NDArray[np.bool_]]:
    """The pores once the last discs of `surfaces` are put into these, each near a pore of these, (n,).

    Besides, which of the T pores are as before, (T,).
    """
    n, T = len(near), len(links.body)
    first = surfaces.discs - n
    room = (2 * n, 2 * n, 6 * n)
    more = Links(
        *(np.concatenate([a, np.zeros((k, *a.shape[1:]), a.dtype)]) for a, k in zip(links, room, strict=True))
    )
    more.body[:T] += np.where(links.body >= first, n, 0)
    before, shapes = more.body.copy(), surfaces.shapes()
    discs = np.column_stack([np.arange(first, first + n), np.zeros((n, 2), np.int64)])
    insert(shapes, more, T, discs, near)
    improve(shapes, more, (more.body != before).any(axis=1))
    same = (more.body[:T] == before[:T]).all(axis=1) & (more.image[:T] == links.image).all(axis=(1, 2))
    return more, same


def numbered(surfaces: BoundingSurfaces, links: Links) -> Pores:
    """The necks by number, and each pore seen from its first disc."""
    body, image, kind = links.body, links.image, surfaces.kind
    kept = np.flatnonzero(np.arange(len(links.twin)) < links.twin)
    first, second = (
        3 * (kept // 3) + (kept + 1 - kept // 3 * 3) % 3,
        3 * (kept // 3) + (kept + 2 - kept // 3 * 3) % 3,
    )
    i, j = body.ravel()[first], body.ravel()[second]
    m = image.reshape(-1, 2)[second] - image.reshape(-1, 2)[first]
    backwards = np.where(i == j, (m[:, 0] < 0) | ((m[:, 0] == 0) & (m[:, 1] < 0)), i > j)
    m = np.where(backwards[:, None], -m, m) * ((kind[i] == DISC) & (kind[j] == DISC))[:, None]
    necks = np.where(backwards[:, None], np.column_stack([j, i]), np.column_stack([i, j]))
    number = np.full(len(links.twin), -1, np.int64)
    number[kept] = number[links.twin[kept]] = np.arange(len(kept))
    base = np.take_along_axis(image, body.argmin(axis=1)[:, None, None], axis=1)
    places = (image - base) * (kind[body] == DISC)[..., None]
    return Pores(
        surfaces, necks, m, lengths_of_necks(surfaces, necks, m), body, places, number.reshape(-1, 3)
    )


def lengths_of_necks(surfaces: BoundingSurfaces, necks: Bodies, image: Bodies) -> Array:
    """The distance of two surfaces, (K,), negative where they overlap."""
    i, j = necks.T
    shapes = surfaces.shapes()
    e = surfaces.centre[j] + image @ shapes.periods - surfaces.centre[i]
    length = np.hypot(e[:, 0], e[:, 1])
    straight = np.where(shapes.kind[j] == WALL, -(e * surfaces.normal[j]).sum(axis=1), length)
    gap: Array = (
        np.where(shapes.kind[j] == CONTAINER, -straight, straight) - shapes.radius[j] - shapes.radius[i]
    )
    return gap


def _require_gaps(pores: Pores) -> None:
    """No two surfaces touch."""
    narrowest_neck = int(np.argmin(pores.neck_gap))
    if not pores.neck_gap[narrowest_neck] > 0.0:
        sides = map(pores.surfaces.side, pores.necks[narrowest_neck])
        raise NoPoresError("{} touch or overlap", *sides)


def _require_clear_necks(surfaces: BoundingSurfaces, links: Links) -> None:
    """No body lies across a neck."""
    clear = clearances(surfaces.shapes(), links)
    worst = int(np.argmin(clear))
    if not clear[worst] > 0.0:
        sides = map(surfaces.side, links.body[worst])
        raise NoPoresError("one of {} lies across the neck between the others", *sides)


@compiled
def clearances(shapes: Shapes, links: Links) -> Array:
    """The smallest clearance in each pore, -inf where it is not run through anticlockwise, (T,)."""
    clear = np.empty(len(links.body))
    for t in range(len(links.body)):
        a, b, c = corner(shapes, links, t, 0), corner(shapes, links, t, 1), corner(shapes, links, t, 2)
        clear[t] = narrowest(shapes, a, b, c) if turn(shapes, a, b, c) > 0.0 else -np.inf
    return clear
