"""Where points lie: in which pore, in which fluid disc."""

from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fsi.arrays import Array, Indices
from fsi.pores.pore_data import pore_data
from fsi.pores.quadrature import DISTANCE, points_at
from fsi.pores.regions import PoreShapes, cross
from fsi.pores.surfaces import BoundingSurfaces
from fsi.pores.system import PoreSystem

# Pores near a point, of which one holds it; so many where none of fewer does, as small ones lie beside large.
_CANDIDATES = (8, 64, 512)
_ROUNDING = 1e-9  # of the size of a pore: points as far as that outside count as inside
_OFF_CORNER = 1e-3  # of the size of a pore: how far off a corner points are taken


def locate(system: PoreSystem, points: Array) -> tuple[Indices, Array]:
    """The pore of each point, (n,), -1 where there is none, and its image in that pore, (n, 2).

    A point lies in the pore to whose sides it lies on the left, and in no body.
    """
    shapes, surfaces = system.shapes, system.pores.surfaces
    middle = shapes.touch.mean(axis=1)
    home = _wrapped(middle, surfaces.periods)
    images = _images(surfaces.periods)
    tree = cKDTree((home + images[:, None]).reshape(-1, 2))
    wrapped, pore, place = _wrapped(points, surfaces.periods), np.full(len(points), -1), points.copy()
    missing = np.arange(len(points))
    for most in _CANDIDATES:
        count = min(most, len(tree.data))
        near = tree.query(wrapped[missing], k=count)[1].reshape(len(missing), count)
        for candidate in near.T[::-1]:  # the nearest has the last word
            number = candidate % len(middle)
            x = wrapped[missing] - images[candidate // len(middle)] + middle[number] - home[number]
            inside = _inside(shapes.of(number), x)
            pore[missing[inside]], place[missing[inside]] = number[inside], x[inside]
        missing = missing[pore[missing] < 0]
        discs = np.arange(surfaces.discs)  # what lies in one lies in no pore
        missing = missing[in_discs(surfaces, discs, wrapped[missing])[0] < 0]
    return pore, place


def _inside(shapes: PoreShapes, x: Array) -> NDArray[np.bool_]:
    """Whether points (n, 2) lie in pores (n)."""
    from_feet = np.moveaxis(x[:, None] - shapes.foot[:, :, 0], -1, 0)
    left = cross(np.moveaxis(shapes.direction, -1, 0), from_feet)
    outside = points_at(pore_data(shapes), x).rows[:, DISTANCE : DISTANCE + 3, 0]
    least = -_ROUNDING * shapes.reach.max(axis=1, keepdims=True)
    return np.asarray(np.all(left >= least, axis=1) & np.all(outside >= least, axis=1))


def in_discs(surfaces: BoundingSurfaces, discs: Indices, points: Array) -> tuple[Indices, Array]:
    """Which of some discs holds each point, (n,), -1 for none, and its image in that disc, (n, 2)."""
    own, place = np.full(len(points), -1), points.copy()
    if len(discs) == 0 or len(points) == 0:
        return own, place
    # Balls, not the nearest centres: a small disc may be nearer to what lies in a large one.
    centre, wrapped = surfaces.centre[discs], _wrapped(points, surfaces.periods)
    tree, home = cKDTree(wrapped), _wrapped(centre, surfaces.periods)
    for image in _images(surfaces.periods):
        found = tree.query_ball_point(home + image, surfaces.radius[discs])
        inside = np.concatenate(found).astype(int)
        disc = np.repeat(np.arange(len(discs)), [len(each) for each in found])
        own[inside] = discs[disc]
        place[inside] = wrapped[inside] - image + centre[disc] - home[disc]
    return own, place


def _images(periods: Array) -> Array:
    """From a period to itself and all its neighbours, (3^P, 2)."""
    around = product((-1.0, 0.0, 1.0), repeat=len(periods))
    return np.array([np.array(c) @ periods.reshape(-1, 2) for c in around]).reshape(-1, 2)


def _wrapped(points: Array, periods: Array) -> Array:
    """Images of points in one period, that around the origin."""
    if len(periods) == 0:
        return points
    return np.asarray(points - np.round(points @ np.linalg.pinv(periods)) @ periods)


def off_corners(shapes: PoreShapes, x: Array) -> tuple[Array, Array]:
    """Points (n, 2) in pores (n), moved away from corners of two walls, and how much nearer they were, (n,).

    In a corner weights are quotients of zeros.
    """
    x, nearer, middle = x.copy(), np.ones(len(x)), shapes.touch.mean(axis=1)
    for v in range(3):
        corner = shapes.foot[:, v, 0]
        r, inwards = x - corner, middle - corner
        away, least = np.hypot(*r.T), _OFF_CORNER * np.hypot(*inwards.T)
        near = ~shapes.direction[:, v].any(axis=1) & (away < least)
        r[away == 0.0] = inwards[away == 0.0]
        nearer[near] = (away / least)[near]
        x[near] = (corner + (least / np.hypot(*r.T))[:, None] * r)[near]
    return x, nearer
