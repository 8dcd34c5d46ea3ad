"""Gaps: the distances between surfaces, of bodies and walls."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fsi.bodies.configuration import Array, Configuration
from fsi.meshes.geometry.containers import Container
from fsi.meshes.geometry.lattice import Lattice


@dataclass(frozen=True, slots=True)
class Gaps:
    """Close pairs and their gaps.

    pairs: bodies (i, j), i < j, or i = j for a body and its own image, shape (P, 2); away: how far the image
    of j that is meant lies from j, a vector of the lattice, shape (P, d), zero without periods; pair_gaps:
    `|q_i - q_j - away| - a_i - a_j`, shape (P,); wall_gaps: distance of each body's surface to each wall,
    shape (N, walls). Negative: overlap.
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
        self.found: Gaps | None = None

    def within(self, reach: float) -> Gaps:
        """All pairs with a gap up to `reach`: of those found before where it is not farther."""
        if self.found is None or reach > self.reach:
            self.found, self.reach = _find_gaps(self.q, self.container, reach), reach
        return self.found if reach == self.reach else self.found.within(reach)


# Of one step many ask for the gaps at its beginning; q is the same object then.
@lru_cache(maxsize=2)
def _search(q: Configuration, container: Container) -> _Search:
    return _Search(q, container)


def _find_gaps(q: Configuration, container: Container, reach: float) -> Gaps:
    largest = float(q.radii.max(initial=0.0))
    pairs, away = _near(q, Lattice(container.periods), 2.0 * largest + reach)
    wall_gaps = container.distances(q.centres) - q.radii[:, None]
    return Gaps(pairs, away, pair_gaps(q, pairs, away), wall_gaps).within(reach)


def _near(q: Configuration, lattice: Lattice, distance: float) -> tuple[NDArray[np.intp], Array]:
    """Pairs of bodies and images whose centres are near each other, and where the images are.

    Bodies are wrapped into one cell; those of the cells around it that are near to it are their images.
    """
    if len(q) == 0:
        return np.empty((0, 2), dtype=np.intp), np.zeros((0, q.dimension))
    m = -np.floor(lattice.coordinates(q.centres)).astype(np.int64)
    home = q.centres + lattice.shift(m)
    tree = cKDTree(home)
    inside = tree.query_pairs(distance, output_type="ndarray").astype(np.intp).reshape(-1, 2)
    original, cell = lattice.images(home, distance)
    around = cKDTree(home[original] + lattice.shift(cell))
    found = tree.sparse_distance_matrix(around, distance, output_type="ndarray")
    i, j = np.concatenate([inside, np.column_stack([found["i"], original[found["j"]]])]).T
    images = np.concatenate([np.zeros((len(inside), lattice.dimension), np.int64), cell[found["j"]]])
    images += m[j] - m[i]
    images[i > j] *= -1
    pairs = np.column_stack([np.minimum(i, j), np.maximum(i, j)])
    order = np.argsort(row_numbers(np.column_stack([pairs, images]))[0])
    away = lattice.shift(images.take(order, axis=0)) + np.zeros((1, q.dimension))
    return pairs.take(order, axis=0), away


def row_numbers(*tables: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """For each row of the tables one number >= 0, ordered like the rows, the same for the same rows."""
    every = np.concatenate(tables)
    if len(every) == 0:
        return [np.empty(0, np.int64) for _ in tables]
    low, high = every.min(axis=0), every.max(axis=0)
    numbers = np.ravel_multi_index(tuple((every - low).T), tuple(high - low + 1))
    return np.split(numbers, np.cumsum([len(table) for table in tables[:-1]]))
