"""Corners of a container that are wider than a straight angle, where walls end within lines they follow."""

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.geometry.container import HERE, Container
from fsi.meshes.geometry.curves import WallCurve
from fsi.meshes.geometry.jets import cross

_BEFORE_END = 1e-6  # of a piece: it goes straight so far
_TURN = 1e-3  # to the right, in radians: from there on it is a corner


def reentrant_corners(container: Container) -> Array:
    """The corners of a container in the plane whose angle, in the fluid, is above pi, (n, 2)."""
    pieces = container.outline()
    if not pieces:
        return np.empty((0, 2))
    begins, ends = (np.array([curve.ends[k] for curve in pieces]) for k in (0, 1))
    first, last = np.array([_directions(curve) for curve in pieces]).swapaxes(0, 1)
    meet = np.linalg.norm(ends[:, None] - begins, axis=2) <= HERE * container.size()
    i, j = np.nonzero(meet)
    return np.asarray(ends[i[cross(last[i], first[j]) < -_TURN]])


def _directions(curve: WallCurve) -> Array:
    """The unit vectors along a piece where it begins and ends, (2, 2)."""
    start, end = curve.interval
    step = _BEFORE_END * (end - start)
    along: Array = np.diff(curve.at(np.array([start, start + step, end - step, end])), axis=0)[[0, 2]]
    return along / np.linalg.norm(along, axis=1, keepdims=True)


def counted(container: Container, x: Array, near: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Of walls near points x (n, d) those that are so by a place of their own, both (n, walls).

    Beside a re-entrant corner the nearest place of both its walls may be the corner. There only the nearer
    wall counts, of two as near the first, so that what counts is continuous around the corner.
    """
    W = near.shape[1]
    if container.faces or np.all(near.sum(axis=1) < 2):  # those with faces are convex
        return near
    away, same = container.distances(x), HERE * container.size()
    feet = (x[:, None] - away[..., None] * container.normals(x)).reshape(-1, x.shape[1])
    shared = np.abs(container.distances(feet).reshape(-1, W, W)) <= same
    farther, first = away[:, :, None] - away[:, None], np.arange(W)[:, None] > np.arange(W)
    passed = shared & near[:, None] & ((farther > same) | ((np.abs(farther) <= same) & first))
    return near & ~np.any(passed, axis=2)
