"""The whole boundary: nodes on the bodies, on the walls of the container, and on the axis or the cut, if any.

A periodic domain is opened along its cut: links, arcs, walls, and whole bodies bound it.
Once around the opened domain, with the fluid on the left: along a link to a body, clockwise around it to the
next link, and on; where a wall is met, along it by one period. Each link is passed twice, on the two sides of
the cut, at places that differ by a vector of the lattice, and gets the same nodes both times. So the nodes
of the two sides match, and each lies on the cut at most twice: where loops cross, there is a body.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fsi.meshes.errors import MeshError, TouchingError
from fsi.meshes.geometry.container import Array, FluidDomain
from fsi.meshes.geometry.curves import segment
from fsi.meshes.planar.cut import NeighbourLinks, cut
from fsi.meshes.planar.rings import arcs, half_ring, rings
from fsi.meshes.planar.sizing import PIECES, Curve, Resolution, Surfaces

LINK_PIECES = 16  # of a link, to begin with


def boundary(domain: FluidDomain, resolution: Resolution) -> list[Curve]:
    """All curves: bodies (tags 1 ... N), walls (N + 1 ...), and the axis or the cut with the last tag.

    Raises MeshError where a body touches another or a wall.
    """
    surfaces = Surfaces.of(domain, resolution)
    if surfaces.lattice.dimension:
        return opened(surfaces)
    every, walls = range(surfaces.bodies), domain.container.outline()
    if not domain.container.axisymmetric:
        return rings(surfaces, every) + [surfaces.wall(curve) for curve in walls]
    halves = [half_ring(surfaces, i) for i in every]
    return halves + [surfaces.wall(curve) for curve in walls] + axis(surfaces)


def axis(surfaces: Surfaces) -> list[Curve]:
    """The pieces of the axis r = 0 between the bodies, with the tag after the last wall's."""
    container, order = surfaces.container, np.argsort(surfaces.centres[:, 1])
    tag = surfaces.bodies + 1 + len(container.walls)
    low, high = container.axis()
    bottoms = [*(surfaces.centres[order, 1] - surfaces.radii[order]), high]
    tops = [low, *(surfaces.centres[order, 1] + surfaces.radii[order])]

    def at(z: Array) -> Array:
        return np.column_stack([np.zeros_like(z), z])

    pieces = zip(tops, bottoms, strict=True)
    return [Curve(tag, at(surfaces.line(at, start, end, PIECES))) for start, end in pieces]


def opened(surfaces: Surfaces) -> list[Curve]:
    """Whole bodies, then what bounds the opened domain: arcs, walls, the cut."""
    links = cut(surfaces)
    if links.gap.min(initial=np.inf) <= 0.0:
        nearest = int(links.gap.argmin())
        place = surfaces.centres[int(links.first[nearest])]
        raise TouchingError("the disc at {} touches a disc or wall, or overlaps it; move it", place)
    walk = list(_walk(links, surfaces))
    opened_bodies = {stretch.node for stretch in walk}
    whole = [i for i in range(surfaces.bodies) if i not in opened_bodies]
    outer = _closed(_curves(walk, links, surfaces))
    shifts = _shifts_inside(surfaces, surfaces.centres[whole], walk, links)
    holes = rings(surfaces, whole)
    return [_moved(hole, shift) for hole, shift in zip(holes, shifts, strict=True)] + outer


@dataclass(frozen=True, slots=True)
class Stretch:
    """From where a link arrives at a node to where the next one leaves it.

    Attributes:
        node: a body, or N + wall.
        centre: of the image that is met, or where the link meets the wall, (2,).
        leaves: the same where the next link leaves: along a wall one period on, (2,).
        start: the angle at which it begins on a body.
        end: the angle at which it ends there, end < start.
        link: the link that leaves.
        forward: whether that leaves in its own direction.
    """

    node: int
    centre: Array
    leaves: Array
    start: float
    end: float
    link: int
    forward: bool


def _walk(links: NeighbourLinks, surfaces: Surfaces) -> Iterator[Stretch]:
    """Once around the opened domain. Raises MeshError where the cut does not open it to one piece."""
    count, n = len(links), surfaces.bodies
    origin, step = np.concatenate([links.first, links.second]), np.concatenate([links.step, -links.step])
    angle = np.arctan2(step[:, 1], step[:, 0])
    # From the centre of the first node of link 0, which is a wall if there are no bodies.
    place = surfaces.centres[int(links.first[0])] if n else surfaces.container.outline()[0].ends[0]
    half, passed = 0, set[int]()
    for _ in range(2 * count):
        passed.add(half)
        arrived = (half + count) % (2 * count)
        node, place = int(origin[arrived]), place + step[half]
        leaving = np.flatnonzero(origin == node)
        turn = (angle[arrived] - angle[leaving]) % (2.0 * np.pi)
        turn[leaving == arrived] = 2.0 * np.pi
        half = int(leaving[np.argmin(turn)])
        start, met = float(angle[arrived]), place
        if node >= n:
            begin, end = surfaces.container.outline()[node - n].ends
            place = place + (end - begin)
        yield Stretch(node, met, place, start, start - float(turn.min()), half % count, half < count)
    if half != 0 or len(passed) != 2 * count:
        raise _not_opened(links, surfaces)


def _curves(walk: list[Stretch], links: NeighbourLinks, surfaces: Surfaces) -> Iterator[Curve]:
    """For each stretch its arc or piece of wall, then the link that leaves it."""
    n = surfaces.bodies
    cut_tag = n + len(surfaces.container.walls) + 1
    along = [_on_link(links, k, surfaces) for k in range(len(links))]
    on_bodies = [stretch for stretch in walk if stretch.node < n]
    angles = np.array([(stretch.end, stretch.start) for stretch in on_bodies]).reshape(-1, 2)
    pieces = iter(arcs(surfaces, [stretch.node for stretch in on_bodies], angles))
    for stretch in walk:
        radius = 0.0
        if stretch.node < n:
            piece = next(pieces)
            moved = _moved(piece, stretch.centre - surfaces.centres[stretch.node])
            opening = None if moved.opening is None else moved.opening[::-1]
            yield Curve(moved.tag, moved.nodes[::-1], centre=moved.centre, opening=opening)
            radius = float(surfaces.radii[stretch.node])
        else:
            yield surfaces.wall(segment(stretch.node - n, stretch.centre, stretch.leaves))
        away, direction = along[stretch.link], links.step[stretch.link] / np.hypot(*links.step[stretch.link])
        if not stretch.forward:
            away, direction = (links.gap[stretch.link] - away)[::-1], -direction
        yield Curve(cut_tag, stretch.leaves + (radius + away)[:, None] * direction)


def _on_link(links: NeighbourLinks, k: int, surfaces: Surfaces) -> Array:
    """Distances of the nodes of a link from the surface of its first node, from 0 to the gap."""
    first = int(links.first[k])
    is_body = first < surfaces.bodies
    begin = surfaces.centres[first] if is_body else np.zeros(2)
    radius = float(surfaces.radii[first]) if is_body else 0.0
    along, gap = links.step[k] / np.hypot(*links.step[k]), float(links.gap[k])
    return surfaces.line(lambda s: begin + (radius + s)[:, None] * along, 0.0, gap, LINK_PIECES)


def _closed(curves: Iterator[Curve]) -> list[Curve]:
    """The same curves, each beginning exactly where the one before ends."""
    once_around = list(curves)
    for before, after in zip([once_around[-1], *once_around], once_around, strict=False):
        after.nodes[0] = before.nodes[-1]
    return once_around


def _moved(curve: Curve, shift: Array) -> Curve:
    centre = None if curve.centre is None else curve.centre + shift
    return Curve(curve.tag, curve.nodes + shift, curve.closed, centre, curve.opening)


def _shifts_inside(surfaces: Surfaces, centres: Array, walk: list[Stretch], links: NeighbourLinks) -> Array:
    """The translations (n, 2) that bring centres (n, 2) into the opened domain.

    Raises MeshError where not exactly one image of a body lies inside.
    """
    lattice = surfaces.lattice
    polygon = np.array([corner for stretch in walk for corner in (stretch.centre, stretch.leaves)])
    extent = np.ceil(np.abs(lattice.coordinates(polygon)).max(axis=0)).astype(int) + 1
    m = np.array(list(product(*(range(-k, k + 1) for k in extent))), dtype=np.int64)
    images = centres[:, None] + lattice.shift(m)
    inside = _inside(polygon, images.reshape(-1, 2)).reshape(len(centres), len(m))
    if not np.all(inside.sum(axis=1) == 1):
        raise _not_opened(links, surfaces)
    return lattice.shift(m[np.argmax(inside, axis=1)])


def _not_opened(links: NeighbourLinks, surfaces: Surfaces) -> MeshError:
    """What to say where the links do not open the domain to one piece that has every body once."""
    narrowest = int(links.gap.argmin())
    place, gap = surfaces.centres[int(links.first[narrowest])], links.gap[narrowest]
    text = "the periodic domain cannot be opened; its narrowest gap, of the disc at {}, is {}: widen it"
    return MeshError(text, place, gap)


def _inside(polygon: Array, x: Array) -> NDArray[np.bool_]:
    """Which points (n, 2) lie in a polygon: a ray to the right crosses its sides an odd number of times."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    crosses = (a[:, 1] > x[:, 1:]) != (b[:, 1] > x[:, 1:])
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (x[:, 1:] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    odd: NDArray[np.bool_] = np.sum(crosses & (x[:, :1] < at), axis=1) % 2 == 1
    return odd
