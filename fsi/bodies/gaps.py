"""Gaps: the distances between surfaces, of bodies and walls."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.neighbours import neighbours
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice

if TYPE_CHECKING:
    from fsi.meshes.geometry.feet import Foot

_WIDER = 1.0 + 1e-12  # so that rounding leaves out no pair at the very end of a reach
# Of the smallest radius: what rounding makes of a gap in contact, and how deep a contact may be solved.
ROUNDING, OVERLAP = 1e-12, 1e-10


@dataclass(frozen=True, slots=True)
class Gaps:
    """Close pairs and their gaps, negative where they overlap.

    Attributes:
        pairs: bodies (i, j), i < j, or i = j for a body and its own image, (P, 2).
        away: how far the image of j that is meant lies from j, a vector of the lattice, (P, d).
        pair_gaps: `|q_i - q_j - away| - a_i - a_j`, (P,).
        wall_gaps: distance of each body's surface to each wall, (N, walls).
    """

    pairs: NDArray[np.intp]
    away: Array
    pair_gaps: Array
    wall_gaps: Array

    def of(self, some: NDArray[np.intp]) -> Gaps:
        """Some of the pairs."""
        pairs, away = self.pairs.take(some, axis=0), self.away.take(some, axis=0)
        return Gaps(pairs, away, self.pair_gaps[some], self.wall_gaps)

    def within(self, reach: float) -> Gaps:
        """The pairs with a gap up to `reach`."""
        return self.of(np.flatnonzero(self.pair_gaps <= reach))

    def smallest(self) -> float:
        """The smallest gap; infinite without bodies."""
        return float(min(self.pair_gaps.min(initial=np.inf), self.wall_gaps.min(initial=np.inf)))

    def smallest_of_each(self) -> Array:
        """The smallest gap of each body, shape (N,)."""
        least = self.wall_gaps.min(axis=1, initial=np.inf)
        for side in range(2):
            np.minimum.at(least, self.pairs[:, side], self.pair_gaps)
        return least


def pair_gaps(q: Configuration, pairs: NDArray[np.intp], away: Array | float = 0.0) -> Array:
    """Gaps `|q_i - q_j - away| - a_i - a_j` of the given pairs (P, 2), of outlines the true ones, (P,)."""
    if q.shaped:
        away = np.broadcast_to(away, (len(pairs), q.dimension))
        each = zip(pairs.tolist(), away, strict=True)
        return np.array([foot_between(q, i, j, e).gap for (i, j), e in each])
    return _gaps_of_circles(q, pairs, away)


def _gaps_of_circles(q: Configuration, pairs: NDArray[np.intp], away: Array | float) -> Array:
    """The same between the circles around the bodies, of shapes at most the true ones, (P,)."""
    i, j = pairs[:, 0], pairs[:, 1]
    separation = q.centres.take(i, axis=0) - q.centres.take(j, axis=0) - away
    distance: Array = np.sqrt(np.einsum("pk,pk->p", separation, separation))
    return distance - q.radii[i] - q.radii[j]


def gap_to_image(q: Configuration, i: int, away: Array) -> float:
    """The gap of body i to its image that lies `away` from it, (d,); of a wide outline at least that.

    Where the circles in it overlap, the outlines do by more, which need not be followed then.
    """
    distance = float(np.linalg.norm(away))
    if not q.outlines:
        return distance - 2.0 * float(q.radii[i])
    body = q.placed[i]
    inscribed = -float(body.signed_distance(body.centre[None])[0][0])
    return distance - 2.0 * inscribed if 2.0 * inscribed > distance else foot_between(q, i, i, away).gap


def wall_gaps(q: Configuration, container: Container) -> Array:
    """The distance of each body's surface to each wall, negative where they overlap, (N, walls)."""
    if q.shaped:
        gaps = [[foot.gap for foot in feet_on_walls(q, i, container)] for i in range(len(q))]
        return np.array(gaps).reshape(len(q), len(container.walls))
    return np.asarray(container.distances(q.centres) - q.radii[:, None])


def foot_between(q: Configuration, i: int, j: int, away: Array | float = 0.0) -> Foot:
    """The gap of body i with a shape to body j, or to its image that lies `away` from it, (d,)."""
    if q.ellipsoids:
        return q.standing[i].gap_to(q.standing[j])  # which have no images
    other = q.placed[j]
    return q.placed[i].gap_to(other.moved(other.centre + away))


def feet_on_walls(q: Configuration, i: int, container: Container) -> list[Foot]:
    """The gaps of body i with a shape to all walls."""
    from fsi.meshes.geometry.wall_feet import feet_in_space, wall_feet

    return wall_feet(q.placed[i], container) if q.outlines else feet_in_space(q.standing[i], container)


def find_gaps(q: Configuration, container: Container, reach: float | None = None) -> Gaps:
    """All pairs of bodies whose gap is at most `reach` (default: the largest diameter), and all wall gaps.

    What is narrowest may be farther: for that there are `nearest_gaps` and `smallest_of_each`. In a periodic
    container also pairs with images, none of them farther than the container is large.
    """
    largest = float(q.radii.max(initial=0.0))
    reach = 2.0 * largest if reach is None else reach
    if len(container.periods):
        reach = min(reach, container.size())
    return _search(q, container).within(reach)


def nearest_gaps(q: Configuration, container: Container) -> Gaps:
    """Gaps among which the smallest of all is, however wide that is; none for a lone body without walls."""
    reach, farthest = 2.0 * float(q.radii.max(initial=0.0)), _farthest(q, container)
    gaps = find_gaps(q, container, reach)
    while 0.0 < reach < min(gaps.smallest(), farthest):
        reach *= 2.0
        gaps = find_gaps(q, container, reach)
    return gaps


def smallest_of_each(q: Configuration, container: Container) -> Array:
    """The smallest gap of each body, however wide, (N,); infinite for a lone body without walls.

    Of a body whose neighbours are all far, the nearest centre b bounds how far the centre of the nearest
    surface can be: `|q_i - q_j| <= |q_i - q_b| - a_b + max a`.
    """
    least, largest = find_gaps(q, container).smallest_of_each(), float(q.radii.max(initial=0.0))
    if q.shaped:
        return find_gaps(q, container, np.inf).smallest_of_each() if np.any(least > 2.0 * largest) else least
    far = np.flatnonzero(least > 2.0 * largest)
    if len(far) == 0 or len(q) + len(container.periods) < 2:
        return least
    import scipy  # late: `fsi check` does without

    home, images, of = _with_images(q, container)
    tree = scipy.spatial.cKDTree(images)
    to_nearest, nearest = (found[:, 1] for found in tree.query(home[far], k=2))  # the first is itself
    reach = to_nearest - q.radii[of[nearest]] + largest
    for i, near in zip(far, tree.query_ball_point(home[far], _WIDER * reach), strict=True):
        distances = np.linalg.norm(images[near] - home[i], axis=1)
        others = distances > 0.0
        gaps = distances[others] - q.radii[of[near]][others] - q.radii[i]
        least[i] = min(least[i], float(gaps.min()))
    return least


def _farthest(q: Configuration, container: Container) -> float:
    """A distance beyond which no centre is from another; images are looked for in the container's size."""
    if len(container.periods):
        return container.size()
    return float(np.linalg.norm(np.ptp(q.centres, axis=0))) if len(q) else 0.0


def _with_images(q: Configuration, container: Container) -> tuple[Array, Array, NDArray[np.intp]]:
    """Centres in one cell (N, d), these and their images as far as a nearest surface may be, and whose.

    No nearest centre is farther than a body's own image, by the shortest period.
    """
    lattice, everyone = Lattice(container.periods), np.arange(len(q))
    home = lattice.wrapped(q.centres) if lattice.dimension else q.centres
    if lattice.dimension == 0:
        return home, home, everyone
    reach = float(np.linalg.norm(lattice.vectors, axis=1).min() + q.radii.max())
    width = reach * np.linalg.norm(np.linalg.pinv(lattice.vectors), axis=0)  # in lattice coordinates
    steps = product(*(range(-n, n + 1) for n in np.ceil(width).astype(int)))
    every = np.concatenate([home + lattice.shift(np.array(m)) for m in steps])
    at = lattice.coordinates(every)
    near = np.flatnonzero(np.all((at >= -width) & (at <= 1.0 + width), axis=1))
    return home, every[near], near % len(q)


class _Search:
    """The gaps of one configuration, as far as they have been asked for."""

    def __init__(self, q: Configuration, container: Container) -> None:
        self.q, self.container = q, container
        self.reach = -np.inf
        self.gaps: Gaps | None = None

    def within(self, reach: float) -> Gaps:
        """All pairs with a gap up to `reach`: of those known already where it is not farther."""
        if self.gaps is None or reach > self.reach:
            self.gaps, self.reach = _find_gaps(self.q, self.container, reach), reach
        return self.gaps if reach == self.reach else self.gaps.within(reach)


# Of one step many ask for the gaps at its beginning; q is the same object then.
@lru_cache(maxsize=2)
def _search(q: Configuration, container: Container) -> _Search:
    return _Search(q, container)


def _find_gaps(q: Configuration, container: Container, reach: float) -> Gaps:
    largest = float(q.radii.max(initial=0.0))
    near, m = neighbours(q.centres, container, _WIDER * (2.0 * largest + reach))
    order = np.argsort(row_numbers(np.column_stack([near, m]))[0])
    pairs, away = near.take(order, axis=0), Lattice(container.periods).shift(m.take(order, axis=0))
    if q.shaped:  # the gap of two outlines takes a thousand times as long as that of the circles around them
        meet = _gaps_of_circles(q, pairs, away) <= reach + ROUNDING * largest
        pairs, away = pairs[meet], away[meet]
    return Gaps(pairs, away, pair_gaps(q, pairs, away), wall_gaps(q, container)).within(reach)


def without_rounding(gaps: Array, radius: float) -> Array:
    """Gaps of bodies that may touch, 0 in contact; radius: the smallest.

    Of contact there are left rounding, of either sign, and overlaps within the tolerance of its solution.
    """
    in_contact = (gaps <= ROUNDING * radius) & (gaps >= -OVERLAP * radius)
    return np.where(in_contact, 0.0, gaps)


def row_numbers(*tables: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """For each row of the tables one number >= 0, ordered like the rows, the same for the same rows."""
    every = np.concatenate(tables)
    if len(every) == 0:
        return [np.empty(0, np.int64) for _ in tables]
    numbers = np.zeros(len(every), np.int64)
    for column in np.ascontiguousarray(every.T):  # least and greatest of columns are slow to find in rows
        low, high = column.min(), column.max()
        numbers *= high - low + 1
        numbers += column - low
    return np.split(numbers, np.cumsum([len(table) for table in tables[:-1]]))
