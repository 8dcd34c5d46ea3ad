"""Pores linked side to side, which compiled loops cut and flip.

A corner of a pore is a surface in a place, the tuple (surface, x, y). Side k of a pore is opposite its corner
k, between the corners k + 1 and k + 2 (mod 3), and has the number 3 * pore + k.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fsi.machine.compiled import internal
from fsi.pores.surfaces import CONTAINER, DISC, WALL, Bodies, Shapes

type Corner = tuple[int, float, float]

OPEN = -1  # the twin of a side that is the corner of a box


class Links(NamedTuple):
    """T pores and how they hang together.

    Attributes:
        body: the surfaces of a pore, anticlockwise, (T, 3).
        image: the coefficients of the periods by which they are translated, (T, 3, 2).
        twin: the number of the same side of the neighbour, whose images may differ by a translation, or OPEN,
            (T * 3,).
    """

    body: Bodies
    image: Bodies
    twin: Bodies


@internal
def cross(ax: float, ay: float, bx: float, by: float) -> float:
    """a x b."""
    return ax * by - ay * bx


@internal
def corner(shapes: Shapes, links: Links, t: int, k: int) -> Corner:
    """Corner k of pore t."""
    return placed(shapes, links.body[t, k], links.image[t, k, 0], links.image[t, k, 1])


@internal
def placed(shapes: Shapes, body: int, m: int, n: int) -> Corner:
    """A surface translated by m and n periods."""
    return moved(shapes, (body, shapes.centre[body, 0], shapes.centre[body, 1]), m, n)


@internal
def moved(shapes: Shapes, a: Corner, m: int, n: int) -> Corner:
    """A corner translated by m and n periods."""
    e = shapes.periods
    return a[0], a[1] + m * e[0, 0] + n * e[1, 0], a[2] + m * e[0, 1] + n * e[1, 1]


@internal
def turn(shapes: Shapes, a: Corner, b: Corner, c: Corner) -> float:
    """Positive where a, b, c go anticlockwise around the region between their necks.

    Discs: twice the area of the triangle of centres. Two discs a, b and a wall, on the left of a -> b: how
    far b's foot lies ahead of a's; and a container: how far b lies ahead of a on the way around, clockwise.
    A disc and two walls: whether these meet in this order; parallel ones do not.
    """
    for _ in range(2):
        if shapes.kind[a[0]] != DISC or (shapes.kind[b[0]] != DISC and shapes.kind[c[0]] == DISC):
            a, b, c = b, c, a
    if shapes.kind[b[0]] != DISC:
        n = shapes.normal
        return cross(n[b[0], 0], n[b[0], 1], n[c[0], 0], n[c[0], 1])
    if shapes.kind[c[0]] == WALL:
        m, n = shapes.normal[c[0], 0], shapes.normal[c[0], 1]
        return cross(m, n, b[1] - a[1], b[2] - a[2])
    if shapes.kind[c[0]] == CONTAINER:
        return cross(b[1] - c[1], b[2] - c[2], a[1] - c[1], a[2] - c[2])
    return cross(b[1] - a[1], b[2] - a[2], c[1] - a[1], c[2] - a[2])


@internal
def across(shapes: Shapes, links: Links, t: int, k: int) -> tuple[Corner, Corner, Corner, Corner]:
    """The corners c, a, b of pore t, of which side k is ab, and d beyond that side, in places next to t."""
    c, a, b = (
        corner(shapes, links, t, k),
        corner(shapes, links, t, (k + 1) % 3),
        corner(shapes, links, t, (k + 2) % 3),
    )
    m, n = carried(shapes, links, t, k)
    h = links.twin[3 * t + k]
    return c, a, b, placed(shapes, links.body[h // 3, h % 3], m, n)


@internal
def step(shapes: Shapes, links: Links, t: int, k: int) -> tuple[int, int]:
    """By how many periods what pore t sees is translated for its neighbour across side k."""
    h = links.twin[3 * t + k]
    i, j = (k + 1) % 3, (h % 3 + 2) % 3  # the same corner of both
    if shapes.kind[links.body[t, i]] != DISC:
        i, j = (k + 2) % 3, (h % 3 + 1) % 3
    u, image = h // 3, links.image
    return image[u, j, 0] - image[t, i, 0], image[u, j, 1] - image[t, i, 1]


@internal
def carried(shapes: Shapes, links: Links, t: int, k: int) -> tuple[int, int]:
    """The image of the corner opposite the twin of side k, seen from pore t."""
    h = links.twin[3 * t + k]
    if shapes.kind[links.body[h // 3, h % 3]] != DISC:
        return 0, 0
    m, n = step(shapes, links, t, k)
    return links.image[h // 3, h % 3, 0] - m, links.image[h // 3, h % 3, 1] - n


@internal
def flip(shapes: Shapes, links: Links, t: int, k: int) -> None:
    """Make the side ab of the pores t = c, a, b and u = d, b, a the side cd of c, a, d and d, b, c."""
    body, image, twin = links.body, links.image, links.twin
    h = twin[3 * t + k]
    u, m = h // 3, h % 3
    a, b = (k + 1) % 3, (k + 2) % 3
    bodies = (body[t, k], body[t, a], body[t, b], body[u, m])
    places = np.empty((4, 2), np.int64)
    places[0], places[1], places[2] = image[t, k], image[t, a], image[t, b]
    places[3] = carried(shapes, links, t, k)
    old = (3 * t + a, 3 * t + b, 3 * u + (m + 1) % 3, 3 * u + (m + 2) % 3)  # the sides bc, ca, ad, db
    new = (3 * u, 3 * t + 2, 3 * t, 3 * u + 2)
    outside = (twin[old[0]], twin[old[1]], twin[old[2]], twin[old[3]])
    for p, corners in ((t, (0, 1, 3)), (u, (3, 2, 0))):
        for q in range(3):
            body[p, q] = bodies[corners[q]]
            image[p, q] = places[corners[q]]
    for p in range(4):
        other = outside[p]
        for q in range(4):  # a pore may be its own neighbour
            if outside[p] == old[q]:
                other = new[q]
        twin[new[p]] = other
        if other >= 0:
            twin[other] = new[p]
    twin[3 * t + 1], twin[3 * u + 1] = 3 * u + 1, 3 * t + 1


@internal
def split(links: Links, t: int, at: tuple[int, int, int], T: int) -> None:
    """Put disc x, (surface, its image), into pore t = a, b, c: a, b, x; pores T, T + 1: b, c, x; c, a, x."""
    body, image, twin = links.body, links.image, links.twin
    bodies, places = body[t].copy(), image[t].copy()
    pores = (t, T, T + 1)
    outside = (twin[3 * t + 2], twin[3 * t], twin[3 * t + 1])
    for p in range(3):
        for q in range(2):
            body[pores[p], q] = bodies[(p + q) % 3]
            image[pores[p], q] = places[(p + q) % 3]
        body[pores[p], 2] = at[0]
        image[pores[p], 2] = at[1:]
        other = outside[p]
        for q in range(3):  # a pore may be its own neighbour
            if outside[p] == 3 * t + (q + 2) % 3:
                other = 3 * pores[q] + 2
        twin[3 * pores[p] + 2] = other
        if other >= 0:
            twin[other] = 3 * pores[p] + 2
    for p in range(3):  # after the sides of pore t were read
        following = pores[(p + 1) % 3]
        twin[3 * pores[p]], twin[3 * following + 1] = 3 * following + 1, 3 * pores[p]
