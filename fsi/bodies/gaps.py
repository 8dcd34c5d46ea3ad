"""Gaps: the distances between surfaces, of bodies and walls."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration
from fsi.meshes.geometry.containers import Container
from fsi.meshes.geometry.lattice import Integers, Lattice


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
    """Gaps `|q_i - q_j - away| - a_i - a_j` of the given pairs (P, 2), shape (P,)."""
    i, j = pairs[:, 0], pairs[:, 1]
    separation = q.centres.take(i, axis=0) - q.centres.take(j, axis=0) - away
    distance: Array = np.sqrt(np.einsum("pk,pk->p", separation, separation))
    return distance - q.radii[i] - q.radii[j]


def find_gaps(q: Configuration, container: Container, reach: float | None = None) -> Gaps:
    """All pairs of bodies whose gap is at most `reach` (default: the largest diameter), and all wall gaps.

    In a periodic container also pairs with images, none of them farther than the container is large.
    """
    largest = float(q.radii.max(initial=0.0))
    reach = 2.0 * largest if reach is None else reach
    if len(container.periods):
        reach = min(reach, container.size())
    return _search(q, container).within(reach)


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
    near, m = neighbours(q.centres, container, 2.0 * largest + reach)
    order = np.argsort(row_numbers(np.column_stack([near, m]))[0])
    pairs, away = near.take(order, axis=0), Lattice(container.periods).shift(m.take(order, axis=0))
    wall_gaps = container.distances(q.centres) - q.radii[:, None]
    return Gaps(pairs, away, pair_gaps(q, pairs, away), wall_gaps).within(reach)


def neighbours(x: Array, container: Container, cutoff: float) -> tuple[NDArray[np.intp], Integers]:
    """All pairs of points x (N, d) and images in a container that are no farther apart than a cutoff.

    Points are wrapped into one cell; those of the cells around it that are near to it are their images. So
    it takes O(N) operations, whatever the periods are.

    Returns:
        the pairs (i, j) in any order, i < j, or i = j for a point and its own image, (P, 2), and the integers
        by which the image of j that is meant is moved, (P, k).
    """
    lattice = Lattice(container.periods)
    if lattice.dimension == 0 and len(x) <= 6:  # pairs so few are done before a tree's library is loaded
        pairs = np.column_stack(np.triu_indices(len(x), 1))
        near = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1) <= cutoff
        return pairs[near], np.empty((near.sum(), 0), np.int64)
    m = -np.floor(lattice.coordinates(x)).astype(np.int64)
    home = x + lattice.shift(m)
    tree = scipy.spatial.cKDTree(home)
    pairs = tree.query_pairs(cutoff, output_type="ndarray").astype(np.intp, copy=False).reshape(-1, 2)
    if lattice.dimension == 0:
        return pairs, np.empty((len(pairs), 0), np.int64)
    original, cell = lattice.images(home, cutoff)
    images = scipy.spatial.cKDTree(home[original] + lattice.shift(cell))
    across = tree.sparse_distance_matrix(images, cutoff, output_type="ndarray")
    inside = len(pairs)
    pairs = np.concatenate([pairs, np.column_stack([across["i"], original[across["j"]]])])
    shift = m.take(pairs[:, 1], axis=0) - m.take(pairs[:, 0], axis=0)
    shift[inside:] += cell[across["j"]]
    backwards = pairs[:, 0] > pairs[:, 1]
    pairs[backwards] = pairs[backwards, ::-1]
    shift[backwards] *= -1
    return pairs, shift


def row_numbers(*tables: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """For each row of the tables one number >= 0, ordered like the rows, the same for the same rows."""
    every = np.concatenate(tables)
    if len(every) == 0:
        return [np.empty(0, np.int64) for _ in tables]
    low, high = every.min(axis=0), every.max(axis=0)
    numbers = np.ravel_multi_index(tuple((every - low).T), tuple(high - low + 1))
    return np.split(numbers, np.cumsum([len(table) for table in tables[:-1]]))
