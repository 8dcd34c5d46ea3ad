"""A cell, periodic along some of its axes and walled across the others.

Lengths are in the user's unit; `d` is 2 for discs and 3 for spheres. Images across periodic sides count like
any other body: `separation` is the vector to the nearest image.
"""

from dataclasses import dataclass

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import NDArray

from fsi.arrays import Array


@dataclass(frozen=True, slots=True)
class SimulationCell:
    """The box from the origin to `sides`, d lengths; walls stand across the axes that are not periodic."""

    sides: tuple[float, ...]
    periodic: tuple[bool, ...]

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.sides)

    @property
    def walled(self) -> NDArray[np.intp]:
        """The axes with walls across them."""
        return np.flatnonzero(~np.array(self.periodic))

    @property
    def volume(self) -> float:
        """Area in the plane, volume in space."""
        return float(np.prod(self.sides))

    def wrapped(self, x: Array) -> Array:
        """The points (n, d) with their periodic coordinates in [0, side)."""
        sides = np.array(self.sides)
        inside = np.where(self.periodic, x - sides * np.floor(x / sides), x)
        return np.where(np.logical_and(self.periodic, inside >= sides), 0.0, inside)  # x = -1e-17 rounds up

    def separation(self, x: Array, y: Array) -> Array:
        """The vectors (n, d) from points y to the nearest images of points x."""
        sides = np.array(self.sides)
        between = x - y
        return between - np.where(self.periodic, sides * np.round(between / sides), 0.0)

    def near_pairs(self, x: Array, reach: float) -> NDArray[np.intp]:
        """Pairs (i, j), i < j, of points (n, d) no further apart than `reach`, sorted, shape (P, 2)."""
        tree = scipy.spatial.cKDTree(self.wrapped(x), boxsize=np.where(self.periodic, self.sides, 0.0))
        pairs = np.sort(tree.query_pairs(reach, output_type="ndarray").astype(np.intp), axis=1)
        order = np.lexsort((pairs[:, 1], pairs[:, 0]))
        return np.asarray(pairs[order])

    def wall_distances(self, x: Array) -> Array:
        """Distance of points (n, d) to the walls, two for each walled axis, shape (n, walls)."""
        across = x[:, self.walled]
        return np.concatenate([across, np.array(self.sides)[self.walled] - across], axis=1)
