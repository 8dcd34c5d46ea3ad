"""Nodes along curves, close enough for given element sizes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.containers import Array

MOST_HALVINGS = 60

Indices = NDArray[np.int64]
type Size = Callable[[Array], Array]
type Sizes = Callable[[Array, Indices], Array]


def resolve(size: Size, start: float, end: float, pieces: int) -> tuple[Array, Array]:
    """Places s along a curve, and the element sizes there, so close that none is missed."""
    s, h, _ = resolve_all(lambda s, _: size(s), np.array([[start, end]]), pieces)
    return s, h


def resolve_all(size: Sizes, ends: Array, pieces: int) -> tuple[Array, Array, Indices]:
    """Places s along curves from ends[k, 0] to ends[k, 1], the element sizes there, and the curve k of each.

    Intervals are halved until they are no longer than half the element size at both their ends.
    """
    s = np.linspace(ends[:, 0], ends[:, 1], pieces + 1, axis=1).ravel()
    k = np.repeat(np.arange(len(ends)), pieces + 1)
    h = size(s, k)
    for _ in range(MOST_HALVINGS):
        too_long = (np.diff(s) > 0.5 * np.minimum(h[:-1], h[1:])) & (k[:-1] == k[1:])
        long = np.flatnonzero(too_long)
        if len(long) == 0:
            return s, h, k
        middle, of = 0.5 * (s[long] + s[long + 1]), k[long]
        h = np.insert(h, long + 1, size(middle, of))
        s, k = np.insert(s, long + 1, middle), np.insert(k, long + 1, of)
    raise MeshError(f"element sizes down to {h.min():.3g} cannot be resolved; is a gap that small meant?")


def equidistribute(s: Array, density: Array, least: int) -> Array:
    """Parameters, with both ends of s, that split `int density ds` into equal parts of at most 1."""
    cumulative = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))])
    parts = max(least, int(np.ceil(cumulative[-1] - 1e-6)))
    placed: Array = np.interp(np.linspace(0.0, cumulative[-1], parts + 1), cumulative, s)
    return placed
