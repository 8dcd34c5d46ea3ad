"""Periodic cells: lattice vectors as rows, (k, d), k = 0 to d; bodies have images at `q + m @ vectors`."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from fsi.bodies import Array

Integers = NDArray[np.int64]


def reduced_basis(vectors: Array) -> Array:
    """The shortest basis of a lattice of two vectors (Lagrange, Gauss); others are given back as they are."""
    if len(vectors) != 2:
        return vectors
    a, b = vectors
    while True:
        if a @ a > b @ b:
            a, b = b, a
        shorter = b - np.rint((a @ b) / (a @ a)) * a
        if shorter @ shorter >= b @ b * (1.0 - 1e-12):
            return np.array([a, b])
        b = shorter


def ghosts(x: Array, vectors: Array, reach: float) -> tuple[NDArray[np.intp], Array]:
    """Images of points that may lie within `reach` of the points (n, d), one of each pair of opposite ones.

    Of the images +s and -s, which give the same pairs, only one is there.

    Args:
        x: points, each wrapped so that its lattice coordinates are in [0, 1).
        vectors: lattice vectors (k, d).
        reach: a length.

    Returns:
        for each ghost its original, (g,), and its translation m @ vectors, (g, d).
    """
    inverse = np.linalg.pinv(vectors)
    coordinates = x @ inverse
    width = reach * np.linalg.norm(inverse, axis=0)  # of the reach in lattice coordinates
    number = np.ceil(width).astype(int)
    originals, shifts = [np.empty(0, dtype=np.intp)], [np.empty((0, x.shape[1]))]
    for m in product(*(range(-n, n + 1) for n in number)):
        if m > (0,) * len(m):
            moved = coordinates + m
            near = np.flatnonzero(np.all((moved >= -width) & (moved <= 1.0 + width), axis=1))
            originals.append(near)
            shifts.append(np.broadcast_to(np.array(m) @ vectors, (len(near), x.shape[1])))
    return np.concatenate(originals), np.concatenate(shifts)


def wrapping(x: Array, vectors: Array) -> Array:
    """The translations (n, d) that carry points to lattice coordinates in [0, 1)."""
    moved: Array = -np.floor(x @ np.linalg.pinv(vectors)) @ vectors
    return moved
