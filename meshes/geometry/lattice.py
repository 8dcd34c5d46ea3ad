"""The lattice of translations that carry a periodic domain onto itself.

Every point, node and body has images at `x + m @ vectors` with integers m. Nothing else in the code knows how
many periods there are: without any, the lattice has no vectors and each point is its only image.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fsi.meshes.geometry.containers import Array

Integers = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Lattice:
    """Lattice vectors e_k as rows, shape (k, 2) with k = 1 or 2; independent, and reduced if there are two.

    Without periods the shape is (0, 1): translations are then zeros that suit points of any dimension.
    Reduced (Lagrange, Gauss): no other basis is shorter, so that the nearest image of a point is among those
    with |m_k| <= 1 after rounding its coordinates.
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
        """Coordinates of points or differences (n, 2) along the lattice vectors, (n, k)."""
        if self.dimension == 0:
            return np.empty((len(x), 0))
        found: Array = x @ np.linalg.pinv(self.vectors)
        return found

    def shift(self, m: Integers) -> Array:
        """The translations m @ vectors, (n, 2), of integers (n, k)."""
        moved: Array = m @ self.vectors
        return moved

    def near(self) -> Integers:
        """All integers with |m_k| <= 1, shape (3^k, k), zero first."""
        every = np.array(list(product((0, -1, 1), repeat=self.dimension)), dtype=np.int64)
        return every.reshape(3**self.dimension, self.dimension)

    def nearest(self, d: Array) -> Integers:
        """The integers m (n, k) for which `d - m @ vectors` is shortest, for differences d (n, 2)."""
        m = np.rint(self.coordinates(d)).astype(np.int64)
        if self.dimension < 2:
            return m
        trials = m[:, None] + self.near()
        lengths = np.sum((d[:, None] - trials @ self.vectors) ** 2, axis=2)
        return trials[np.arange(len(d)), np.argmin(lengths, axis=1)]

    def wrapped(self, x: Array) -> Array:
        """The images of points (n, 2) with lattice coordinates in [0, 1)."""
        return x - self.shift(np.floor(self.coordinates(x)).astype(np.int64))

    def images(self, x: Array, distance: float) -> tuple[NDArray[np.intp], Integers]:
        """The images that may lie within `distance` of points (n, d) in the cell, one of each opposite two.

        Of the images x_j + s and x_j - s, which lie from others as these do from them, only one is there.

        Returns:
            for each image its original, (g,), and the integers m that shift it, (g, k).
        """
        at = self.coordinates(x)
        width = distance * np.linalg.norm(np.linalg.pinv(self.vectors), axis=0)  # in lattice coordinates
        shifts = np.array(list(product(*(range(-n, n + 1) for n in np.ceil(width).astype(int)))), np.int64)
        shifts = shifts.reshape(len(shifts), self.dimension)
        originals, m = [np.empty(0, np.intp)], [np.empty((0, self.dimension), np.int64)]
        for shift in shifts[positive(shifts)]:
            near = np.flatnonzero(np.all((at + shift >= -width) & (at + shift <= 1.0 + width), axis=1))
            originals.append(near)
            m.append(np.tile(shift, (len(near), 1)))
        return np.concatenate(originals), np.concatenate(m)


NO_LATTICE = Lattice(np.empty((0, 1)))


def positive(m: Integers) -> NDArray[np.bool_]:
    """Of every two opposite shifts (n, k) one: that whose first component other than 0 is positive."""
    found: NDArray[np.bool_] = np.sign(m) @ 3.0 ** -np.arange(m.shape[1]) > 0.0
    return found


def reduced(vectors: Array) -> Array:
    """The shortest basis of the lattice of two vectors (2, 2), by Lagrange's and Gauss's algorithm."""
    a, b = vectors
    if a @ a > b @ b:
        a, b = b, a
    while True:
        b = b - np.rint((a @ b) / (a @ a)) * a
        if a @ a <= b @ b:
            return np.array([a, b])
        a, b = b, a
