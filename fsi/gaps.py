"""Gaps: the distances between surfaces, of bodies and walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fsi.bodies import Array, Configuration
from meshes.geometry import Container


@dataclass(frozen=True, slots=True)
class Gaps:
    """Close pairs and their gaps.

    pairs: bodies (i, j), i < j, shape (P, 2); pair_gaps: `|q_i - q_j| - a_i - a_j`, shape (P,);
    wall_gaps: distance of each body's surface to each wall, shape (N, walls). Negative: overlap.
    """

    pairs: NDArray[np.intp]
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


def pair_gaps(q: Configuration, pairs: NDArray[np.intp]) -> Array:
    """Gaps `|q_i - q_j| - a_i - a_j` of the given pairs (P, 2), shape (P,)."""
    i, j = pairs[:, 0], pairs[:, 1]
    separation = q.centres[i] - q.centres[j]
    return np.linalg.norm(separation, axis=1) - q.radii[i] - q.radii[j]


def find_gaps(q: Configuration, container: Container, reach: float | None = None) -> Gaps:
    """All pairs of bodies whose gap is at most `reach` (default: the largest diameter), and all wall gaps."""
    largest = float(q.radii.max(initial=0.0))
    reach = 2.0 * largest if reach is None else reach
    pairs = np.empty((0, 2), dtype=np.intp)
    if len(q) > 1:
        near = cKDTree(q.centres).query_pairs(2.0 * largest + reach, output_type="ndarray")
        pairs = np.sort(near.astype(np.intp), axis=1)
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    gaps = pair_gaps(q, pairs)
    close = gaps <= reach
    return Gaps(pairs[close], gaps[close], container.distances(q.centres) - q.radii[:, None])
