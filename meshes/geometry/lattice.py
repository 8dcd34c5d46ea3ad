"""The lattice of translations that carry a periodic domain onto itself.

Every point, node and body has images at `x + m @ vectors` with integers m. Nothing else in the code knows how
many periods there are: without any, the lattice has no vectors and each point is its only image. A box may
have periods in some directions; a cell (`cell`) is periodic along as many vectors as its points have
coordinates, and moves.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, partial, reduce
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.meshes.geometry.container import lengths

SAME_PLACE = 1e-9  # of the longest period
ROUNDING = 1e-13  # of lengths


@dataclass(frozen=True, slots=True)
class Lattice:
    """The translations m @ vectors.

    Attributes:
        vectors: e_k as rows, (k, d) with k from 0 to d; independent, and reduced (see `reduced`).

    No other basis is shorter, so that two points with the same nearest image differ by |m_k| <= 1. Orthogonal
    vectors are reduced.
    """

    vectors: Array

    @property
    def dimension(self) -> int:
        """Number of periods k."""
        return len(self.vectors)

    def longest(self) -> float:
        """Length of the longest lattice vector."""
        return float(np.linalg.norm(self.vectors, axis=1).max(initial=0.0))

    def coordinates(self, x: Array) -> Array:
        """Coordinates of points or differences (n, d) along the lattice vectors, (n, k)."""
        if self.dimension == 0:
            return np.empty((len(x), 0))
        coordinates: Array = x @ self._inverse
        return coordinates

    @property
    def _inverse(self) -> Array:
        """Points times it are their coordinates, (d, k)."""
        return _inverse(np.asarray(self.vectors, dtype=float).tobytes(), self.vectors.shape)

    def shift(self, m: Indices) -> Array:
        """The translations m @ vectors, (n, d), of integers (n, k)."""
        moved: Array = m @ self.vectors
        return moved

    def near(self, reach: float = 0.0) -> Indices:
        """All integers with |m_k| <= 1, shape (n, k), zero first; or as many periods as `reach` is long."""
        most = np.maximum(np.ceil(self._widths(reach)).astype(int), 1)
        every = list(product(*(sorted(range(-n, n + 1), key=abs) for n in most)))
        return np.array(every, dtype=np.int64).reshape(len(every), self.dimension)

    def _widths(self, distance: float) -> Array:
        """How far a distance goes at most along each vector, in lattice coordinates, (k,)."""
        if self.dimension == 0 or distance == 0.0:  # asked for often in a step
            return np.zeros(self.dimension)
        return np.asarray(distance * np.linalg.norm(self._inverse, axis=0))

    def nearest(self, d: Array) -> Indices:
        """The integers m (n, k) for which `d - m @ vectors` is shortest, for differences d (n, d)."""
        m = np.rint(self.coordinates(d)).astype(np.int64)
        if self.dimension < 2:
            return m
        # Where none of its neighbours is nearer an image is the nearest. In the plane one step leads there.
        for _ in range(self.dimension - 1):
            trials = m[:, None] + self.near()
            squares = np.sum((d[:, None] - trials @ self.vectors) ** 2, axis=2)
            m = trials[np.arange(len(d)), np.argmin(squares, axis=1)]
        return m

    def wrapped(self, x: Array) -> Array:
        """The images of points (n, d) with lattice coordinates in [0, 1)."""
        return x - self.shift(np.floor(self.coordinates(x)).astype(np.int64))

    def images(self, x: Array, distance: float) -> tuple[NDArray[np.intp], Indices]:
        """The images that may lie within `distance` of points (n, d) in the cell, one of each opposite two.

        Of the images x_j + s and x_j - s, which lie from others as these do from them, only one is there.

        Returns:
            for each image its original, (g,), and the integers m that shift it, (g, k).
        """
        at = self.coordinates(x)
        width = self._widths(distance)
        steps = [range(-n, n + 1) for n in np.ceil(width).astype(int)]
        # Few points are near a side of the cell: they are looked up once, and sought in no other way.
        at_side = {
            (k, m): np.flatnonzero((at[:, k] + m >= -width[k]) & (at[:, k] + m <= 1.0 + width[k]))
            for k, m in ((k, m) for k, every in enumerate(steps) for m in every if m)
        }
        shifts = np.array(list(product(*steps)), np.int64).reshape(-1, self.dimension)
        originals, m = [np.empty(0, np.intp)], [np.empty((0, self.dimension), np.int64)]
        for shift in shifts[positive(shifts)]:
            sides = [at_side[k, int(step)] for k, step in enumerate(shift) if step]
            near = reduce(partial(np.intersect1d, assume_unique=True), sides)
            originals.append(near)
            m.append(np.tile(shift, (len(near), 1)))
        return np.concatenate(originals), np.concatenate(m)


def positive(m: Indices) -> NDArray[np.bool_]:
    """Of every two opposite shifts (n, k) one: that whose first component other than 0 is positive."""
    first_positive: NDArray[np.bool_] = np.sign(m) @ 3.0 ** -np.arange(m.shape[1]) > 0.0
    return first_positive


def reduced(vectors: Array) -> Array:
    """The shortest basis of the lattice of two or three vectors (d, d).

    In the plane by Lagrange's and Gauss's algorithm; in space the longest vector is shortened by the lattice
    of the other two, as long as that helps (Nguyen and Stehle 2009, ACM Trans. Algorithms 5:46) by more than
    rounding: in a hexagonal lattice three vectors are as long as each other.
    """
    if len(vectors) == 1:
        return vectors
    while True:
        basis = vectors[np.argsort(lengths(vectors), kind="stable")]
        shorter, last = reduced(basis[:-1]), basis[-1:]
        lattice = Lattice(shorter)
        last = last - lattice.shift(lattice.nearest(last))
        vectors = np.concatenate([shorter, last])
        if lengths(vectors[-2:-1]) <= (1.0 + ROUNDING) * lengths(last):
            return vectors


def unit_shear(dimension: int) -> Array:
    """The gradient of u = y e_x, in space of u = z e_x, (d, d)."""
    return np.outer(np.eye(dimension)[0], np.eye(dimension)[-1])


@lru_cache(maxsize=8)  # a mesh in a channel asks for it a hundred times
def _inverse(vectors: bytes, shape: tuple[int, int]) -> Array:
    """The pseudo-inverse of the rows that these are the numbers of, (d, k)."""
    inverse = np.asarray(np.linalg.pinv(np.frombuffer(vectors).reshape(shape)))
    inverse.flags.writeable = False
    return inverse
