"""Gaps: the distances between surfaces, of bodies and walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fsi.bodies import Array, Configuration
from meshes.geometry import Container
from meshes.lattice import Lattice, positive


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
    separation = q.centres[i] - q.centres[j] - away
    return np.linalg.norm(separation, axis=1) - q.radii[i] - q.radii[j]


def find_gaps(q: Configuration, container: Container, reach: float | None = None) -> Gaps:
    """All pairs of bodies whose gap is at most `reach` (default: the largest diameter), and all wall gaps.

    In a periodic container also pairs with the nearest images, those next to the cell that bodies are
    wrapped into.
    """
    largest = float(q.radii.max(initial=0.0))
    reach = 2.0 * largest if reach is None else reach
    lattice = Lattice(container.periods)
    pairs, away = (
        _near(q, lattice, 2.0 * largest + reach) if lattice.dimension else _inside(q, largest, reach)
    )
    gaps = pair_gaps(q, pairs, away)
    close = gaps <= reach
    wall_gaps = container.distances(q.centres) - q.radii[:, None]
    return Gaps(pairs[close], away[close], gaps[close], wall_gaps)


def _inside(q: Configuration, largest: float, reach: float) -> tuple[NDArray[np.intp], Array]:
    """Pairs of near bodies where there are no images."""
    pairs = np.empty((0, 2), dtype=np.intp)
    if len(q) > 1:
        near = cKDTree(q.centres).query_pairs(2.0 * largest + reach, output_type="ndarray")
        pairs = np.sort(near.astype(np.intp), axis=1)
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    return pairs, np.zeros((len(pairs), q.dimension))


def _near(q: Configuration, lattice: Lattice, distance: float) -> tuple[NDArray[np.intp], Array]:
    """Pairs of bodies and images whose centres are near each other, and where the images are.

    Neighbours of one cell are looked for in that cell and the cells around it.
    """
    home = lattice.wrapped(q.centres)
    m = lattice.near()
    images = (lattice.shift(m)[:, None] + home).reshape(-1, q.dimension)
    found = cKDTree(home).sparse_distance_matrix(cKDTree(images), distance, output_type="ndarray")
    i, (cell, j) = found["i"], np.divmod(found["j"], max(len(q), 1))
    once = (i < j) | ((i == j) & positive(m[cell]))
    i, j, cell = i[once], j[once], cell[once]
    order = np.lexsort((cell, j, i))
    i, j, cell = i[order], j[order], cell[order]
    away = images[cell * len(q) + j] - home[i] + q.centres[i] - q.centres[j]
    # Exactly a vector of the lattice, whatever the coordinates lost in wrapping.
    away = lattice.shift(np.rint(lattice.coordinates(away)).astype(np.int64))
    return np.column_stack([i, j]).astype(np.intp), away
