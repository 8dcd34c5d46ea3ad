"""The pieces into which links between surfaces divide a periodic domain: the faces of their graph.

A periodic domain is opened along its cut: links, arcs, walls, and whole bodies bound it. Further links
divide it. Once around a piece, with the fluid on the left: along a link to a body, clockwise around it to the
next link, and on; where a wall is met, along it to the next link or by one period. Each link is passed twice,
on its two sides. Pieces are laid side by side, each beside one that has its place; where the two sides of a
link then fall together it lies inside, elsewhere they differ by a vector of the lattice: they are the cut.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, parted
from fsi.meshes.errors import MeshError
from fsi.meshes.planar.links import NeighbourLinks
from fsi.meshes.planar.sizing import Surfaces

TOGETHER = 1e-6  # of the size of the domain, by which places of the same node differ
TURN = 2.0 * np.pi


@dataclass(frozen=True, slots=True)
class Stretch:
    """From where a link arrives at a node to where the next one leaves it.

    Attributes:
        node: a body, or N + wall.
        centre: of the image that is met, or where the link meets the wall, (2,).
        leaves: the same where the next link leaves: elsewhere along a wall, (2,).
        start: the angle at which it begins on a body.
        end: the angle at which it ends there, end < start.
        half: the half-link that leaves.
    """

    node: int
    centre: Array
    leaves: Array
    start: float
    end: float
    half: int


type Face = list[Stretch]


class HalfLinks:
    """Links in both directions: half k < n is link k, half n + k the same backwards."""

    def __init__(self, links: NeighbourLinks, surfaces: Surfaces) -> None:
        """Of these links between the surfaces."""
        self.links, self.surfaces, self.count = links, surfaces, len(links)
        self.arms = np.append(surfaces.arms, np.zeros(len(surfaces.container.walls)))
        self.origin = np.concatenate([links.first, links.second])
        self.step = np.concatenate([links.step, -links.step])
        self.along = np.concatenate([links.along, -links.along])
        self.foot = np.concatenate([links.feet[:, 0], links.feet[:, 1]])
        self.angle = links.turns.T.ravel()
        order = np.argsort(self.origin, kind="stable")
        nodes, first = np.unique(self.origin[order], return_index=True)
        self._leaving = dict(zip(nodes.tolist(), parted(order, first[1:].tolist()), strict=True))
        for wall, curve in enumerate(surfaces.container.outline()):
            leave = np.flatnonzero(self.origin == surfaces.bodies + wall)
            begin, end = curve.ends
            s = (self._foot(leave, begin) - begin) @ (end - begin) / ((end - begin) @ (end - begin))
            # Along a wall one period counts as a turn does around a body.
            self.angle[leave] = -TURN * s

    def _foot(self, halves: NDArray[np.int64], begin: Array) -> Array:
        """Where halves leave a wall, (n, 2); without bodies where it begins."""
        if self.surfaces.bodies == 0:
            return np.tile(begin, (len(halves), 1))
        back = self.twin(halves)
        foot: Array = self.surfaces.centres[self.origin[back]] + self.step[back]
        return foot

    def twin[T: (int, NDArray[np.int64])](self, half: T) -> T:
        """The same link in the other direction."""
        return (half + self.count) % (2 * self.count)

    def start(self) -> Array:
        """A place of the node that half 0 leaves."""
        walls = [curve.ends[0] for curve in self.surfaces.container.outline()]
        place: Array = self.surfaces.centres[int(self.origin[0])] if self.surfaces.bodies else walls[0]
        return place

    def around(self, first: int, place: Array) -> Iterator[Stretch]:
        """Once around the face on the left of half `first`, which leaves from that place."""
        half = first
        for _ in range(2 * self.count):
            arrived = self.twin(half)
            node, met = int(self.origin[arrived]), place + self.step[half]
            leaving = self._leaving[node]
            turn = (self.angle[arrived] - self.angle[leaving]) % TURN
            turn[leaving == arrived] = TURN
            half, least = int(leaving[np.argmin(turn)]), float(turn.min())
            place = met + least / TURN * self._period(node)
            start = float(self.angle[arrived])
            yield Stretch(node, met, place, start, start - least, half)
            if half == first:
                return

    def _period(self, node: int) -> Array:
        """From image to image along a wall; zero for a body, around which one comes back."""
        if node < self.surfaces.bodies:
            return np.zeros(2)
        begin, end = self.surfaces.container.outline()[node - self.surfaces.bodies].ends
        period: Array = end - begin
        return period

    def corners(self, stretch: Stretch) -> Array:
        """What a stretch leaves of a piece, inside the body or along its outline, (n, 2)."""
        if stretch.node >= self.surfaces.bodies or not self.surfaces.placed:
            return np.array([stretch.centre, stretch.leaves])
        body = self.surfaces.placed[stretch.node].moved(stretch.centre)
        return body.between(stretch.end / TURN, stretch.start / TURN)[::-1]

    def meet(self, one: Array, other: Array) -> bool:
        """Whether two places are the same."""
        return bool(np.hypot(*(one - other)) < TOGETHER * self.surfaces.container.size())

    def not_opened(self) -> MeshError:
        """What to say where the links do not divide the domain into pieces that have every body once."""
        narrowest = int(self.links.gap.argmin())
        place, gap = self.surfaces.centres[int(self.links.first[narrowest])], self.links.gap[narrowest]
        text = "the periodic domain cannot be opened; its narrowest gap, of the {} at {}, is {}: widen it"
        return MeshError(text.replace("{}", self.surfaces.word, 1), place, gap)


@dataclass(frozen=True)
class Faces:
    """The pieces side by side.

    Attributes:
        halves: the links.
        faces: once around each.
        places: from where each half leaves, by its number.
    """

    halves: HalfLinks
    faces: list[Face]
    places: dict[int, Array]

    @staticmethod
    def of(halves: HalfLinks) -> Faces:
        """Lay them side by side. Raises MeshError where a piece does not close or cannot be reached."""
        places, faces = {0: halves.start()}, list[Face]()
        passed, waiting = set[int](), deque([0])
        while waiting:
            first = waiting.popleft()
            if first in passed:
                continue
            face = list(halves.around(first, places[first]))
            if not halves.meet(face[-1].leaves, places[first]):
                raise halves.not_opened()
            for stretch, following in zip(face, [*face[1:], face[0]], strict=True):
                passed.add(stretch.half)
                places[stretch.half] = stretch.leaves
                beside = halves.twin(stretch.half)
                places.setdefault(beside, following.centre)
                waiting.append(beside)
            faces.append(face)
        if len(passed) != 2 * halves.count:
            raise halves.not_opened()
        return Faces(halves, faces, places)

    @cached_property
    def face_of(self) -> dict[int, int]:
        """The face on the left of each half."""
        return {stretch.half: k for k, face in enumerate(self.faces) for stretch in face}

    def is_inside(self, half: int) -> bool:
        """Whether the two sides of a link fall together."""
        there = self.places[half] + self.halves.step[half]
        return self.halves.meet(there, self.places[self.halves.twin(half)])

    def shifts(self, bodies: list[int]) -> tuple[Array, NDArray[np.int64]]:
        """The translations (n, 2) that bring bodies into a piece, and which it is, (n,).

        Raises MeshError where not exactly one image of a body lies in one piece.
        """
        surfaces, lattice = self.halves.surfaces, self.halves.surfaces.lattice
        polygons = [np.concatenate([*map(self.halves.corners, face)]) for face in self.faces]
        extent = np.ceil(np.abs(lattice.coordinates(np.concatenate(polygons))).max(axis=0)).astype(int) + 1
        m = np.array(list(product(*(range(-k, k + 1) for k in extent))), dtype=np.int64)
        images = surfaces.inside(bodies)[:, None] + lattice.shift(m)
        inside = np.stack([_inside(polygon, images.reshape(-1, 2)) for polygon in polygons], axis=1)
        inside = inside.reshape(len(bodies), len(m) * len(polygons))  # by image, then by piece
        if not np.all(inside.sum(axis=1) == 1):
            raise self.halves.not_opened()
        image, piece = np.divmod(np.argmax(inside, axis=1), len(polygons))
        return lattice.shift(m[image]), piece


def _inside(polygon: Array, x: Array) -> NDArray[np.bool_]:
    """Which points (n, 2) lie in a polygon: a ray to the right crosses its sides an odd number of times."""
    odd = np.zeros(len(x), dtype=bool)
    near = np.flatnonzero(np.all((x > polygon.min(axis=0)) & (x < polygon.max(axis=0)), axis=1))
    a, b, x = polygon, np.roll(polygon, -1, axis=0), x[near]
    crosses = (a[:, 1] > x[:, 1:]) != (b[:, 1] > x[:, 1:])
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (x[:, 1:] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    odd[near] = np.sum(crosses & (x[:, :1] < at), axis=1) % 2 == 1
    return odd
