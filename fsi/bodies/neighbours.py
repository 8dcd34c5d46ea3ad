"""Points near each other, in a container and among their images."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

# A tree that is asked once is made in half the time like this, and answers as fast.
_QUICK = {"balanced_tree": False, "compact_nodes": False}
_FEW = 64  # points whose pairs are all looked at, in less time than a tree's library takes to load


def neighbours(x: Array, container: Container, cutoff: float) -> tuple[NDArray[np.intp], Indices]:
    """All pairs of points x (N, d) and images in a container that are no farther apart than a cutoff.

    Points are wrapped into one cell; those of the cells around it that are near to it are their images. So
    it takes O(N) operations, whatever the periods are.

    Returns:
        the pairs (i, j) in any order, i < j, or i = j for a point and its own image, (P, 2), and the integers
        by which the image of j that is meant is moved, (P, k).
    """
    lattice = Lattice(container.periods)
    m = -np.floor(lattice.coordinates(x)).astype(np.int64)
    home = x + lattice.shift(m)
    near = _Few(home, cutoff) if len(x) <= _FEW else _Trees(home, cutoff)
    pairs = near.pairs()
    if lattice.dimension == 0:
        return pairs, np.empty((len(pairs), 0), np.int64)
    original, cell = lattice.images(home, cutoff)
    images = home[original] + lattice.shift(cell)
    i, j = near.to(images)
    inside = len(pairs)
    pairs = np.concatenate([pairs, np.column_stack([i, original[j]])])
    shift = m.take(pairs[:, 1], axis=0) - m.take(pairs[:, 0], axis=0)
    shift[inside:] += cell[j]
    backwards = pairs[:, 0] > pairs[:, 1]
    pairs[backwards] = pairs[backwards, ::-1]
    shift[backwards] *= -1
    return pairs, shift


class _Few:
    """Pairs of points (N, d) within a cutoff, by all distances."""

    def __init__(self, x: Array, cutoff: float) -> None:
        self.x, self.cutoff = x, cutoff

    def pairs(self) -> NDArray[np.intp]:
        """i < j, (P, 2)."""
        i, j = self.to(self.x)
        return np.column_stack([i[i < j], j[i < j]])

    def to(self, y: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Of x and of y (n, d)."""
        apart = self.x[:, None] - y
        i, j = np.nonzero(np.sqrt(np.einsum("ijk,ijk->ij", apart, apart)) <= self.cutoff)
        return i, j


class _Trees:
    """The same by trees of points."""

    def __init__(self, x: Array, cutoff: float) -> None:
        self.tree, self.cutoff = _tree(x), cutoff

    def pairs(self) -> NDArray[np.intp]:
        pairs = self.tree.query_pairs(self.cutoff, output_type="ndarray")
        return np.asarray(pairs, np.intp).reshape(-1, 2)

    def to(self, y: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        found = self.tree.sparse_distance_matrix(_tree(y), self.cutoff, output_type="ndarray")
        return found["i"], found["j"]


def _tree(x: Array) -> cKDTree:
    import scipy  # late: `fsi check` does without

    return scipy.spatial.cKDTree(x, **_QUICK)
