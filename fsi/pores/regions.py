"""Where the pores lie: their surfaces, the necks that bound them, and the circle inscribed in each.

The three vertices of a pore are surfaces, anticlockwise; side v is the neck between vertices v + 1 and v + 2
(mod 3), directed from the first to the second, so that the pore lies on its left.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.machine.compiled import compiled, internal
from fsi.pores.surfaces import CONTAINER, DISC, WALL
from fsi.pores.topology import Pores

# Of Newton's method: at most so many steps, the last of this part of the radius; normals that are parallel.
_ROUNDS, _CLOSE, _ALIKE = 12, 1e-10, 1e-9
_KEPT = 0.2, 0.8  # parts of an arc between which the inscribed circle may touch it
NEXT, OTHER = [1, 2, 0], [2, 0, 1]  # the vertices v + 1 and v + 2, between which side v lies


class PoreShapes(NamedTuple):
    """Of E pores, for compiled loops.

    Attributes:
        kind: DISC, WALL or CONTAINER of each vertex, (E, 3).
        centre: of its circle; of a wall a point on it, (E, 3, 2).
        radius: of its circle, 0 for walls, (E, 3).
        normal: of walls, into the fluid, 0 for circles, (E, 3, 2).
        foot: where side v meets its first and its second surface, (E, 3, 2, 2).
        direction: unit vector of side v; of a corner of walls 0, (E, 3, 2).
        gap: length of side v, (E, 3).
        touch: a point on the arc of each vertex, as a rule where the inscribed circle touches it, (E, 3, 2).
        turn: +1 where side v runs as its neck is directed, -1 where it runs against it, (E, 3).
        reach: distance between centres (or to the wall) of the neck, the unit of length across it, (E, 3).
        fluid: whether a vertex is a disc of fluid, (E, 3).
        reference: where psi of a surface is its number c: of a disc the foot of its narrowest neck, so that
            what slides there makes no flux; else the centre, (E, 3, 2).
    """

    kind: NDArray[np.int8]
    centre: Array
    radius: Array
    normal: Array
    foot: Array
    direction: Array
    gap: Array
    touch: Array
    turn: Array
    reach: Array
    fluid: NDArray[np.bool_]
    reference: Array

    def of(self, chosen: NDArray[np.int64]) -> "PoreShapes":
        """Those of some pores."""
        return PoreShapes._make(part[chosen] for part in self)


class Vertex(NamedTuple):
    """One surface of each of E pores, or all three, as in `PoreShapes`."""

    kind: NDArray[np.int8]
    centre: Array
    radius: Array
    normal: Array

    def of(self, chosen: NDArray[np.bool_]) -> "Vertex":
        """That of some pores."""
        return Vertex._make(part[chosen] for part in self)

    @property
    def signed_radius(self) -> Array:
        """Negative where the fluid is inside."""
        return np.where(self.kind == CONTAINER, -self.radius, self.radius)


def shapes_of(pores: Pores) -> PoreShapes:
    """The shapes of all pores; whether they are sound shows in their areas."""
    surfaces, V = pores.surfaces, pores.vertices
    periods = np.zeros((2, 2))
    periods[: len(surfaces.periods)] = surfaces.periods
    centre = surfaces.centre[V] + pores.image @ periods
    kind, radius, normal = surfaces.kind[V], surfaces.radius[V], surfaces.normal[V]
    vertices = [Vertex(kind[:, v], centre[:, v], radius[:, v], normal[:, v]) for v in range(3)]
    sides = [_neck(vertices[NEXT[v]], vertices[OTHER[v]]) for v in range(3)]
    foot, direction, gap = (np.stack(part, axis=1) for part in zip(*sides, strict=True))
    gap[pores.sides < 0], direction[pores.sides < 0] = 0.0, 0.0
    turn = np.where(_runs_along(pores), 1.0, -1.0)
    size = np.where(kind == CONTAINER, 0.0, radius)
    reach = gap + size[:, NEXT] + size[:, OTHER]
    touch, fluid = _touch(vertices, foot), surfaces.fluid[V]
    reference = centre + references(pores, foot - centre[:, [NEXT, OTHER]].swapaxes(1, 2), gap)[V]
    return PoreShapes(
        kind, centre, radius, normal, foot, direction, gap, touch, turn, reach, fluid, reference
    )


def references(pores: Pores, arms: Array, gap: Array) -> Array:
    """From each centre to its reference, (B, 2), by arms of feet, (E, 3, 2, 2), and gaps, (E, 3)."""
    surfaces = pores.surfaces
    ends = np.stack([pores.vertices[:, NEXT], pores.vertices[:, OTHER]], axis=2)
    widest_first = np.argsort(-np.repeat(gap.ravel(), 2), kind="stable")
    offset = np.zeros((len(surfaces), 2))
    offset[ends.ravel()[widest_first]] = arms.reshape(-1, 2)[widest_first]
    offset[(surfaces.kind != DISC) | surfaces.fluid] = 0.0
    return offset


def _runs_along(pores: Pores) -> NDArray[np.bool_]:
    """Whether each side of each pore has the direction of its neck, (E, 3)."""
    along = np.zeros(pores.sides.shape, bool)
    for v in range(3):
        i, j = pores.vertices[:, NEXT[v]], pores.vertices[:, OTHER[v]]
        shift = pores.image[:, OTHER[v]] - pores.image[:, NEXT[v]]
        neck = pores.necks[pores.sides[:, v]]
        # A wall is its own image, so only circles can be mistaken for their images.
        walls = (pores.surfaces.kind[i] != DISC) | (pores.surfaces.kind[j] != DISC)
        same = np.all(shift == pores.neck_image[pores.sides[:, v]], axis=1) | walls
        along[:, v] = (neck[:, 0] == i) & (neck[:, 1] == j) & same
    return along


def _neck(first: Vertex, second: Vertex) -> tuple[Array, Array, Array]:
    """Feet (E, 2, 2), direction (E, 2) and length (E,) of the shortest segments between surfaces."""
    wall, other_wall = first.kind == WALL, second.kind == WALL
    a, b = first.signed_radius, second.signed_radius
    between = second.centre - first.centre
    apart = np.linalg.norm(between, axis=1)
    # A neck to a container leads away from its centre.
    side = np.where((first.kind == CONTAINER) | (second.kind == CONTAINER), -1.0, 1.0)
    n = between * (side / np.where(apart > 0.0, apart, 1.0))[:, None]
    n = np.where(wall[:, None], first.normal, np.where(other_wall[:, None], -second.normal, n))
    foot, other = first.centre + a[:, None] * n, second.centre - b[:, None] * n
    other = np.where(other_wall[:, None], _projected(foot, second), other)
    foot = np.where((wall & ~other_wall)[:, None], _projected(other, first), foot)
    # From centres and radii: the difference of the feet has lost the digits of a narrow gap.
    along = np.where(wall | other_wall, np.sum(between * n, axis=1), side * apart)
    corner = wall & other_wall
    if np.any(corner):
        foot[corner] = other[corner] = _meeting(first.of(corner), second.of(corner))
    return np.stack([foot, other], 1), n, along - a - b


def _projected(points: Array, wall: Vertex) -> Array:
    """The points of walls nearest to points, (E, 2)."""
    return points - np.sum((points - wall.centre) * wall.normal, axis=1)[:, None] * wall.normal


def _meeting(first: Vertex, second: Vertex) -> Array:
    """Where two walls meet, x . n = c . n for both, (E, 2)."""
    n = np.stack([first.normal, second.normal], 1)
    rhs = np.stack([np.sum(wall.centre * wall.normal, axis=1) for wall in (first, second)], 1)
    meeting: Array = np.linalg.solve(n, rhs[..., None])[..., 0]
    return meeting


def _touch(vertices: list[Vertex], foot: Array) -> Array:
    """Where the inscribed circle touches, kept between 0.2 and 0.8 of each arc, (E, 3, 2).

    Where it touches beyond, a disc may hide one kept point from another. Strips end in the lines between
    them, and would fold: the point on that disc is then where it is nearest to the line of the two others.
    """
    bounds = Vertex(*(np.stack(part, axis=1) for part in zip(*vertices, strict=True)))
    middle = _inscribed(bounds, foot.mean(axis=(1, 2)))
    arcs = [np.stack([foot[:, OTHER[v], 0], foot[:, NEXT[v], 1]]) for v in range(3)]
    touch = np.stack([_kept(*pair, middle) for pair in zip(vertices, arcs, strict=True)], axis=1)
    for v, (vertex, arc) in enumerate(zip(vertices, arcs, strict=True)):
        here, first, second = touch[:, v], touch[:, NEXT[v]], touch[:, OTHER[v]]
        away = np.stack([first - here, second - here])
        hidden = (vertex.kind == DISC) & np.any(np.sum(away * (here - vertex.centre), axis=2) <= 0.0, axis=0)
        if np.any(hidden):
            x, y = (second - first)[hidden].T
            nearest = vertex.centre[hidden] + np.stack([y, -x], axis=1)  # the disc is on the left of the line
            touch[hidden, v] = _kept(vertex.of(hidden), arc[:, hidden], nearest)
    return touch


def _kept(vertex: Vertex, arc: Array, x: Array) -> Array:
    """The points of arcs, from the first to the second of (2, E, 2), towards x, (E, 2)."""
    start, end = arc
    along = end - start
    t = np.sum((x - start) * along, 1) / np.sum(along * along, 1)
    straight = start + np.clip(t, *_KEPT)[:, None] * along
    s, e = start - vertex.centre, end - vertex.centre
    full, part = _angle(s, e), _angle(s, x - vertex.centre)
    bent = vertex.centre + _rotated(s, np.clip(part / np.where(full == 0.0, 1.0, full), *_KEPT) * full)
    return np.where((vertex.kind == WALL)[:, None], straight, bent)


def cross(a: Array, b: Array) -> Array:
    """a_x b_y - a_y b_x of vectors (2, ...)."""
    product: Array = a[0] * b[1] - a[1] * b[0]
    return product


def _angle(s: Array, e: Array) -> Array:
    """The angle from s to e in (-pi, pi], (E,)."""
    angle: Array = np.arctan2(cross(s.T, e.T), np.sum(s * e, axis=1))
    return angle


def _rotated(s: Array, angle: Array) -> Array:
    """Vectors (E, 2) turned by angles."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([cos * s[:, 0] - sin * s[:, 1], sin * s[:, 0] + cos * s[:, 1]], 1)


@compiled
def _inscribed(bounds: Vertex, start: Array) -> Array:
    """Centres of the circles that touch the three surfaces, (E, 3, ...), by Newton's method, (E, 2)."""
    found, d, n = start.copy(), np.empty(3), np.empty((3, 2))
    for e in range(len(found)):
        x, rho = found[e], 0.0
        for _ in range(_ROUNDS):
            for v in range(3):
                d[v] = _distance(bounds, e, v, x, n[v])
            # n_v . s - t = d_v - rho for the steps s of x and t of rho
            ax, ay, bx, by = n[1, 0] - n[0, 0], n[1, 1] - n[0, 1], n[2, 0] - n[0, 0], n[2, 1] - n[0, 1]
            p, q, area = d[1] - d[0], d[2] - d[0], ax * by - ay * bx
            if abs(area) <= _ALIKE:  # where no circle touches all three the start stays
                break
            sx, sy = (p * by - q * ay) / area, (ax * q - bx * p) / area
            x[0], x[1] = x[0] - sx, x[1] - sy
            rho = d[0] - n[0, 0] * sx - n[0, 1] * sy
            if max(abs(sx), abs(sy)) <= _CLOSE * abs(rho):
                break
    return found


@internal
def _distance(bounds: Vertex, e: int, v: int, x: Array, normal: Array) -> float:
    """Distance of a point to surface v of pore e, and its gradient, (2,)."""
    rx, ry = x[0] - bounds.centre[e, v, 0], x[1] - bounds.centre[e, v, 1]
    if bounds.kind[e, v] == WALL:
        normal[:] = bounds.normal[e, v]
        return float(rx * normal[0] + ry * normal[1])
    length, sign = np.sqrt(rx * rx + ry * ry), -1.0 if bounds.kind[e, v] == CONTAINER else 1.0
    over = sign / length if length > 0.0 else 0.0
    normal[0], normal[1] = over * rx, over * ry
    return float(sign * (length - bounds.radius[e, v]))
