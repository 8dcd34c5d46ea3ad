"""The shape of pores: their inscribed circles, and how far their bodies keep clear of their necks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.machine.compiled import compiled, internal
from fsi.pores.links import Corner, Links, across, corner, cross, flip, turn
from fsi.pores.surfaces import CONTAINER, DISC, WALL, Bodies, Shapes

CLEAR = 0.3  # radii between a body and a neck opposite, which a flip may bring about
# Where pores are flat the weights change within a part of them, and would ask for many points of quadrature.
FLAT = 0.15  # distance of a disc from the neck opposite over the length of that
FLAT_AT_WALL = 0.24  # the same of a wall from the centres of the neck's discs
FLAT_IN_CORNER = 0.4  # the same where the neck leads to the next wall of a box
STRAIGHT = 0.45  # sine of the angle between a neck to a container and the line of the neck opposite
_EQUAL = 1e-6  # circles as far as that from a body, over their radius, touch it
_ROUNDS = 100


@internal
def norm(x: float, y: float) -> float:
    """|(x, y)|; `hypot`, which minds the largest numbers too, takes several times as long."""
    return float(np.sqrt(x * x + y * y))


@internal
def distance(shapes: Shapes, x: float, y: float, a: Corner) -> float:
    """Of the point (x, y) from a surface, positive in the fluid."""
    kind, r = shapes.kind[a[0]], shapes.radius[a[0]]
    if kind == WALL:
        normal = shapes.normal
        return float((x - a[1]) * normal[a[0], 0] + (y - a[2]) * normal[a[0], 1])
    length = norm(x - a[1], y - a[2])
    return float(-r - length if kind == CONTAINER else length - r)


@internal
def _tangent(shapes: Shapes, a: Corner, b: Corner) -> tuple[float, float, float, float]:
    """e, p, f: centres a + y of circles of radius rho that touch disc a and b have e.y = p + f rho."""
    x, y, r, s = b[1] - a[1], b[2] - a[2], shapes.radius[a[0]], shapes.radius[b[0]]
    if shapes.kind[b[0]] == WALL:
        m, n = shapes.normal[b[0], 0], shapes.normal[b[0], 1]
        return m, n, x * m + y * n, 1.0
    return x, y, 0.5 * (x * x + y * y - s * s + r * r), r - s


@internal
def inscribed(shapes: Shapes, a: Corner, b: Corner, c: Corner) -> tuple[float, float, float]:
    """Centre and radius of the least circle between three surfaces that touches them; nan for none."""
    for _ in range(2):
        if shapes.kind[a[0]] != DISC:
            a, b, c = b, c, a
    ex, ey, p, f = _tangent(shapes, a, b)
    hx, hy, q, g = _tangent(shapes, a, c)
    area = cross(ex, ey, hx, hy)
    if area == 0.0:
        return np.nan, np.nan, np.nan
    ux, uy = (p * hy - q * ey) / area, (q * ex - p * hx) / area
    vx, vy = (f * hy - g * ey) / area, (g * ex - f * hx) / area
    r = shapes.radius[a[0]]
    # |u + v rho| = r + rho
    A, B, C = vx * vx + vy * vy - 1.0, ux * vx + uy * vy - r, ux * ux + uy * uy - r * r
    root = B * B - A * C
    rho = C / (np.sqrt(root) - B) if root >= 0.0 and np.sqrt(root) > B else np.nan
    return a[1] + ux + vx * rho, a[2] + uy + vy * rho, rho


@internal
def conflict(shapes: Shapes, a: Corner, b: Corner, c: Corner, d: Corner) -> float:
    """Distance of d from the inscribed circle of a, b, c over its radius, as by `_from_circle`."""
    return _from_circle(shapes, inscribed(shapes, a, b, c), d)


@internal
def _from_circle(shapes: Shapes, circle: tuple[float, float, float], d: Corner) -> float:
    """Distance of d from a circle over its radius; -inf where there is none."""
    x, y, rho = circle
    return distance(shapes, x, y, d) / rho - 1.0 if rho > 0.0 else -np.inf


@internal
def neck(shapes: Shapes, a: Corner, b: Corner) -> tuple[float, float]:
    """The vector along the neck from a to b: between centres, or between a centre and its foot."""
    sign = 1.0
    if shapes.kind[a[0]] != DISC:
        a, b, sign = b, a, -1.0
    x, y = b[1] - a[1], b[2] - a[2]
    if shapes.kind[b[0]] == WALL:
        m, n = shapes.normal[b[0], 0], shapes.normal[b[0], 1]
        h = x * m + y * n
        return sign * h * m, sign * h * n
    if shapes.kind[b[0]] == CONTAINER:
        sign += sign * shapes.radius[b[0]] / norm(x, y)  # the radius is negative
    return sign * x, sign * y


@internal
def from_neck(shapes: Shapes, x: float, y: float, a: Corner, b: Corner) -> float:
    """Distance of a point from the neck ab and what prolongs it to centres."""
    if shapes.kind[a[0]] != DISC:
        a, b = b, a
    ex, ey = neck(shapes, a, b)
    u, v = x - a[1], y - a[2]
    along = min(max((u * ex + v * ey) / (ex * ex + ey * ey), 0.0), 1.0)
    return norm(u - along * ex, v - along * ey)


@internal
def clearance(shapes: Shapes, c: Corner, a: Corner, b: Corner) -> float:
    """Distance of disc c from the neck ab over its radius, or over theirs if less; infinite for a wall."""
    if shapes.kind[c[0]] != DISC or (shapes.kind[a[0]] != DISC and shapes.kind[b[0]] != DISC):
        return np.inf
    r, s = shapes.radius[c[0]], max(shapes.radius[a[0]], shapes.radius[b[0]])
    return float((from_neck(shapes, c[1], c[2], a, b) - r) / min(r, s))


@internal
def is_flat(shapes: Shapes, c: Corner, a: Corner, b: Corner) -> bool:
    """Whether c is near the neck ab for its length; of a container, whether ab leads to it.

    In the corner of a long box c may be the wall along the neck from a disc to the far end.
    """
    kind = shapes.kind
    if kind[c[0]] == CONTAINER:
        return min(_sine(a, b, c), _sine(b, a, c)) <= STRAIGHT
    if kind[c[0]] == WALL:
        near, part = np.inf, FLAT_AT_WALL
        for end in (a, b):
            if kind[end[0]] == DISC:
                near = min(near, distance(shapes, end[1], end[2], c))
            else:
                part = FLAT_IN_CORNER
        return bool(near <= part * length_of(shapes, a, b))
    if kind[a[0]] != DISC and kind[b[0]] != DISC:
        return False
    near = from_neck(shapes, c[1], c[2], a, b) - shapes.radius[c[0]]
    return bool(near <= FLAT * length_of(shapes, a, b))


@compiled
def flat_ones(shapes: Shapes, bodies: Bodies, places: Array) -> NDArray[np.bool_]:
    """Which pores are flat, (E,), of their three surfaces, (E, 3), in these places, (E, 3, 2)."""
    found = np.zeros(len(bodies), np.bool_)
    for e in range(len(bodies)):
        a, b, c = _at(bodies, places, e, 0), _at(bodies, places, e, 1), _at(bodies, places, e, 2)
        for _ in range(3):
            a, b, c = b, c, a
            found[e] = found[e] or is_flat(shapes, c, a, b)
    return found


@internal
def _at(bodies: Bodies, places: Array, e: int, v: int) -> Corner:
    """Corner v of pore e."""
    return bodies[e, v], places[e, v, 0], places[e, v, 1]


@internal
def length_of(shapes: Shapes, a: Corner, b: Corner) -> float:
    """The length of the neck ab."""
    ex, ey = neck(shapes, a, b)
    return float(norm(ex, ey) - max(shapes.radius[a[0]], 0.0) - max(shapes.radius[b[0]], 0.0))


@internal
def _sine(a: Corner, b: Corner, c: Corner) -> float:
    """|sine| of the angle at a between b and c."""
    ex, ey, hx, hy = b[1] - a[1], b[2] - a[2], c[1] - a[1], c[2] - a[2]
    lengths = norm(ex, ey) * norm(hx, hy)
    return float(abs(cross(ex, ey, hx, hy)) / lengths) if lengths > 0.0 else 1.0


@internal
def narrowest(shapes: Shapes, a: Corner, b: Corner, c: Corner) -> float:
    """The smallest clearance in a pore."""
    return min(clearance(shapes, a, b, c), clearance(shapes, b, c, a), clearance(shapes, c, a, b))


@internal
def _urgency(shapes: Shapes, links: Links, h: int, before: float, worst: float) -> float:
    """What side h of a pore asks for a flip by, the less the sooner; infinite where it should stay.

    It asks for one where a body is too near to a neck of its two pores, or in the inscribed circle of its
    neighbour: their least clearance, and the least distance from a circle over its radius, are given.
    """
    if before >= CLEAR and worst >= -_EQUAL:
        return np.inf
    c, a, b, d = across(shapes, links, h // 3, h % 3)
    if turn(shapes, c, a, d) <= 0.0 or turn(shapes, d, b, c) <= 0.0:
        return np.inf
    after = min(narrowest(shapes, c, a, d), narrowest(shapes, d, b, c))
    if before < CLEAR and after > before:
        return before - CLEAR
    best = min(conflict(shapes, c, a, d, b), conflict(shapes, d, b, c, a))
    return 1.0 + worst if after >= min(CLEAR, before) and min(best, -_EQUAL) > worst else np.inf


def improve(shapes: Shapes, links: Links, new: NDArray[np.bool_]) -> None:
    """Flip sides of new pores, and of those that come of it, that ask for it most first, until none asks."""
    last = np.where(new, -1, -2)  # the round in which a pore was flipped
    for count in range(_ROUNDS):
        sides, urgency = _pending(shapes, links, last, count - 1)
        if len(sides) == 0:
            return
        _flip_apart(shapes, links, sides[np.argsort(urgency, kind="stable")], last)


@compiled
def _flip_apart(shapes: Shapes, links: Links, sides: Bodies, last: Bodies) -> None:
    """Flip those of these sides whose pores were not flipped for one before."""
    count = last.max() + 1
    for h in sides:
        t, u = h // 3, links.twin[h] // 3
        if last[t] < count and last[u] < count:
            flip(shapes, links, t, h % 3)
            last[t] = last[u] = count


@compiled
def _pending(shapes: Shapes, links: Links, last: Bodies, count: int) -> tuple[Bodies, Array]:
    """The sides of pores flipped in round `count` that ask for a flip, and their urgency."""
    sides, urgency = np.empty(len(links.twin) // 2, np.int64), np.empty(len(links.twin) // 2)
    known, seen = np.zeros(len(links.body), np.bool_), np.empty((len(links.body), 4))
    n = 0
    for h in range(len(links.twin)):
        twin = links.twin[h]
        t, u = h // 3, twin // 3
        if h < twin and t != u and max(last[t], last[u]) == count:
            for pore in (t, u):
                if not known[pore]:
                    known[pore] = True
                    _see(shapes, links, pore, seen[pore])
            worst = min(_beyond(shapes, links, h, seen[t]), _beyond(shapes, links, twin, seen[u]))
            wish = _urgency(shapes, links, h, min(seen[t, 3], seen[u, 3]), worst)
            if wish < np.inf:
                sides[n], urgency[n] = h, wish
                n += 1
    return sides[:n], urgency[:n]


@internal
def _see(shapes: Shapes, links: Links, t: int, seen: Array) -> None:
    """Centre and radius of the circle in pore t, and its smallest clearance."""
    a, b, c = corner(shapes, links, t, 0), corner(shapes, links, t, 1), corner(shapes, links, t, 2)
    seen[0], seen[1], seen[2] = inscribed(shapes, a, b, c)
    seen[3] = narrowest(shapes, a, b, c)


@internal
def _beyond(shapes: Shapes, links: Links, h: int, circle: Array) -> float:
    """Distance of what is beyond side h from the circle in its pore, as by `conflict`."""
    return _from_circle(shapes, (circle[0], circle[1], circle[2]), across(shapes, links, h // 3, h % 3)[3])
