"""Points that say which of them are near: by a tree, whose library loads slowly, only where they are many."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array

if TYPE_CHECKING:
    import scipy

type Indices = NDArray[np.intp]

_FEW = 6


class NearbyPoints:
    """Points in the plane that are asked for those near others."""

    def __init__(self, points: Array) -> None:
        """The points, (n, 2)."""
        self.points = points

    @property
    def few(self) -> bool:
        """Whether there are so few that all of them are looked at."""
        return len(self.points) <= _FEW

    def nearest(self, x: Array, k: int) -> tuple[Array, Indices]:
        """Distances of each x (m, 2) to its k <= n nearest points, and which these are, both (m, k)."""
        if not self.few:
            away, which = self._tree.query(x, k=[*range(1, k + 1)])
            return away, which
        distances = self.distances(x)
        order = np.argsort(distances, axis=1, kind="stable")[:, :k]
        return np.take_along_axis(distances, order, axis=1), order

    def within(self, x: Array, reach: Array) -> list[list[int]]:
        """Of each x (m, 2) the points no farther than its reach (m,), in their order."""
        if not self.few:
            found: list[list[int]] = self._tree.query_ball_point(x, reach, return_sorted=True).tolist()
            return found
        return [np.flatnonzero(near).tolist() for near in self.distances(x) <= reach[:, None]]

    def pairs(self, x: Array, farthest: float) -> tuple[Indices, Indices]:
        """Which of x (m, 2) and which points are no farther apart than this; each pair once."""
        if not self.few:
            import scipy  # late: `fsi check` does without

            tree = scipy.spatial.cKDTree(x)
            found = tree.sparse_distance_matrix(self._tree, farthest, output_type="ndarray")
            return found["i"], found["j"]
        of_x, point = np.nonzero(self.distances(x) <= farthest)
        return of_x, point

    def distances(self, x: Array) -> Array:
        """From each x to each point, (m, n)."""
        step = x[:, None] - self.points
        distances: Array = np.sqrt(np.square(step).sum(axis=2))
        return distances

    @cached_property
    def _tree(self) -> scipy.spatial.cKDTree:
        import scipy  # late: `fsi check` does without

        return scipy.spatial.cKDTree(self.points)
