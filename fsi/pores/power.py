"""The power triangulation of discs between walls: where every search for pores begins.

The power of a point is |x - c|^2 - r^2 of the disc to which it is least. Discs whose regions of least power
meet, inside the container, share a neck; a region that meets a wall has a neck to the wall, and where a
corner of a box lies in a region, the disc has the pore in the corner. Discs that do not overlap all
have a region. Discs are put in one after the other and sides are flipped until all agree with these rules
(Lawson; Edelsbrunner and Shah 1996, Incremental topological flipping works for regular triangulations).
"""

from __future__ import annotations

import numpy as np

from fsi.machine.compiled import compiled, internal
from fsi.pores.links import Corner, Links, across, corner, cross, flip, moved, placed, split, step, turn
from fsi.pores.surfaces import DISC, WALL, Bodies, Shapes

TILT = 3e-8  # a linear map of this size decides between equal choices, alike in all images


@internal
def _power_centre(shapes: Shapes, a: Corner, b: Corner, c: Corner) -> tuple[float, float, float]:
    """Where discs a, b, c have equal powers, seen from a, times the last number, twice their triangle."""
    ex, ey, p = _power_line(shapes, a, b)
    fx, fy, q = _power_line(shapes, a, c)
    return p * fy - q * ey, q * ex - p * fx, cross(ex, ey, fx, fy)


@internal
def _power_line(shapes: Shapes, a: Corner, b: Corner) -> tuple[float, float, float]:
    """The normal e = b - a and e.(x - a) of points x of equal powers; tilted a little."""
    x, y = b[1] - a[1], b[2] - a[2]
    x, y = x + TILT * y, y + 0.3 * TILT * x
    r, s = shapes.radius[a[0]], shapes.radius[b[0]]
    return x, y, 0.5 * (x * x + y * y - s * s + r * r)


@internal
def beyond(shapes: Shapes, a: Corner, b: Corner, c: Corner, d: Corner) -> bool:
    """Whether the power centre of discs a, b, c is nearer to disc d, or outside the wall or container d."""
    x, y, area = _power_centre(shapes, a, b, c)
    if shapes.kind[d[0]] == DISC:
        hx, hy, p = _power_line(shapes, a, d)
        return x * hx + y * hy > p * area
    x, y = x + area * (a[1] - d[1]), y + area * (a[2] - d[2])
    if shapes.kind[d[0]] == WALL:
        return bool(x * shapes.normal[d[0], 0] + y * shapes.normal[d[0], 1] < 0.0)
    return bool(x * x + y * y > (shapes.radius[d[0]] * area) ** 2)


@internal
def _power_at_corner(shapes: Shapes, v: int, w: int, a: Corner) -> float:
    """The power to disc a of the point where two walls meet."""
    m, n = shapes.normal[v], shapes.normal[w]
    p = (shapes.centre[v, 0] - a[1]) * m[0] + (shapes.centre[v, 1] - a[2]) * m[1]
    q = (shapes.centre[w, 0] - a[1]) * n[0] + (shapes.centre[w, 1] - a[2]) * n[1]
    area = cross(m[0], m[1], n[0], n[1])
    x, y = (p * n[1] - q * m[1]) / area, (q * m[0] - p * n[0]) / area
    return float(x * x + y * y - shapes.radius[a[0]] ** 2)


@internal
def _wrong(shapes: Shapes, c: Corner, a: Corner, b: Corner, d: Corner) -> bool:
    """Whether the side ab between the pores c, a, b and d, b, a is not of the power triangulation."""
    kind = shapes.kind
    solid_c, solid_d = kind[c[0]] != DISC, kind[d[0]] != DISC
    if solid_c and solid_d:
        return False
    if kind[a[0]] == DISC and kind[b[0]] == DISC:
        return beyond(shapes, d, b, a, c) if solid_c else beyond(shapes, c, a, b, d)
    wall, disc = (a, b) if kind[b[0]] == DISC else (b, a)
    if solid_c or solid_d:
        other, x = (c, d) if solid_c else (d, c)
        at = _power_at_corner(shapes, wall[0], other[0], x), _power_at_corner(shapes, wall[0], other[0], disc)
        return at[0] < at[1]
    first, last = (d, c) if wall[0] == a[0] else (c, d)
    return turn(shapes, first, disc, last) > 0.0 and not beyond(shapes, first, disc, last, wall)


@internal
def _settle(shapes: Shapes, links: Links, queue: Bodies, waiting: int) -> None:
    """Flip sides, those in the queue and what they change, until all are of the power triangulation.

    A side that cannot be flipped waits until one of its two pores is another.
    """
    number, queued = queue[0], queue[1]
    head, room, left = 0, len(number), 20 * len(number) + 1000
    for i in range(waiting):
        queued[number[i]] = 1
    while waiting > 0 and left > 0:
        h = number[head]
        head, waiting, left = (head + 1) % room, waiting - 1, left - 1
        queued[h] = 0
        t, k = h // 3, h % 3
        twin = links.twin[h]
        if twin < 0 or twin // 3 == t:
            continue
        c, a, b, d = across(shapes, links, t, k)
        if not _wrong(shapes, c, a, b, d):
            continue
        if turn(shapes, c, a, d) <= 0.0 or turn(shapes, d, b, c) <= 0.0:
            continue
        flip(shapes, links, t, k)
        for side in (3 * t, 3 * t + 2, 3 * (twin // 3), 3 * (twin // 3) + 2):
            if queued[side] == 0 and (links.twin[side] < 0 or queued[links.twin[side]] == 0):
                number[(head + waiting) % room] = side
                queued[side] = 1
                waiting += 1


@internal
def locate(shapes: Shapes, links: Links, t: int, x: Corner) -> tuple[int, int, int]:
    """The pore in which a point lies, and by how many periods it is translated there, by a walk from pore t.

    The point is given as that of some disc's number. At each pore the walk begins with another side, in a
    fixed sequence, so that it does not go in circles; where rounding keeps it from an end, it stops.
    """
    m, n, seed = 0, 0, 12345
    for _ in range(10 * len(links.body) + 100):
        seed = (1103515245 * seed + 12345) % 2147483648
        stays = True
        at = moved(shapes, x, m, n)
        for i in range(3):
            k = (seed // 65536 + i) % 3
            a, b = corner(shapes, links, t, (k + 1) % 3), corner(shapes, links, t, (k + 2) % 3)
            if links.twin[3 * t + k] >= 0 and turn(shapes, a, b, at) < 0.0:
                dm, dn = step(shapes, links, t, k)
                t, m, n, stays = links.twin[3 * t + k] // 3, m + dm, n + dn, False
                break
        if stays:
            break
    return t, m, n


@compiled
def insert(shapes: Shapes, links: Links, T: int, discs: Bodies, near: Bodies) -> None:
    """Put discs into the first T pores, two more for each, and flip sides around them.

    The discs are rows (surface, its image); `near` has a pore near each, in whose place the image is, or -1
    for that of the disc before.
    """
    t, before, behind = 0, 0, 0  # a pore, and by how many periods that before lay off its disc's image
    queue = np.zeros((2, 3 * len(links.body)), np.int64)
    for i in range(len(discs)):
        if near[i] >= 0:
            t, before, behind = near[i], 0, 0
        disc, p, q = discs[i, 0], discs[i, 1] + before, discs[i, 2] + behind
        t, m, n = locate(shapes, links, t, placed(shapes, disc, p, q))
        before, behind = before + m, behind + n
        split(links, t, (disc, p + m, q + n), T)
        queue[0, 0], queue[0, 1], queue[0, 2] = 3 * t + 2, 3 * T + 2, 3 * T + 5
        T += 2
        _settle(shapes, links, queue, 3)
