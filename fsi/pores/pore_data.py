"""The numbers of each pore of which its trial functions are made, in columns that have names."""

from itertools import accumulate

import numpy as np

from fsi.bodies.configuration import Array
from fsi.pores.regions import PoreShapes
from fsi.pores.surfaces import CONTAINER, WALL

# What there is of each vertex v, or of side v, with the number of its columns; the last two, of the pore,
# stand beside each vertex. An affine function c + g . (x - o) is o, g, c.
_WIDTHS = {
    "distance": 6,  # centre, normal of a wall, sign, 1 for a wall
    "half square": 5,  # centre, sign, radius, 0 for a wall and 1 else
    "turn x": 5,  # x - x_v and y - y_v; walls do not turn: 0
    "turn y": 5,
    "along": 5,  # x and y from where psi of the surface is its number c
    "up": 5,
    "x / a": 5,  # from the centre, over the radius
    "y / a": 5,
    "line": 5,  # e_v; 1 at a corner of two walls, where nothing has to vanish
    "across": 5,  # e_v times its height over the distance D of the centres; 0 at a corner
    "direction": 2,
    "turn": 1,
    "1 / a": 1,
    "x / size": 5,  # coordinates from the middle of the pore that are 1 at the farthest arc
    "y / size": 5,
}
_STARTS = dict(zip(_WIDTHS, accumulate(_WIDTHS.values(), initial=0), strict=False))
_VERTEX = sum(_WIDTHS.values())


def column(name: str, v: int = 0) -> int:
    """The first column of what has this name, of vertex or side v."""
    return _STARTS[name] + v * _VERTEX


def pore_data(shapes: PoreShapes) -> Array:
    """All columns, (E, .)."""
    one = np.ones_like(shapes.gap)
    zero = 0.0 * one
    wall, bent = np.where(shapes.kind == WALL, one, 0.0), np.where(shapes.kind == WALL, 0.0, one)
    sign = np.where(shapes.kind == CONTAINER, -one, 1.0)
    inverse = 1.0 / np.where(shapes.radius > 0.0, shapes.radius, 1.0)
    corner = shapes.gap <= 0.0
    n, foot = shapes.direction, shapes.foot[:, :, 0]
    upright = np.stack([-n[..., 1], n[..., 0]], -1)
    height = np.where(corner, 1.0, np.sum(upright * (shapes.touch - foot), axis=2))[..., None]
    reach = np.where(corner, 1.0, shapes.reach)[..., None]
    middle = np.broadcast_to(shapes.touch.mean(axis=1)[:, None], foot.shape)
    size = np.linalg.norm(shapes.touch - middle, axis=2).max(axis=1)[:, None] * one
    columns = {
        "distance": (shapes.centre, shapes.normal, sign, wall),
        "half square": (shapes.centre, sign, shapes.radius, bent),
        "turn x": (shapes.centre, bent, zero, zero),
        "turn y": (shapes.centre, zero, bent, zero),
        "along": (shapes.reference, one, zero, zero),
        "up": (shapes.reference, zero, one, zero),
        "x / a": (shapes.centre, inverse, zero, zero),
        "y / a": (shapes.centre, zero, inverse, zero),
        "line": (foot, upright / height, np.where(corner, one, 0.0)),
        "across": (foot, upright / reach, zero),
        "direction": (n,),
        "turn": (shapes.turn,),
        "1 / a": (inverse,),
        "x / size": (middle, 1.0 / size, zero, zero),
        "y / size": (middle, zero, 1.0 / size, zero),
    }
    parts = [part.reshape(*one.shape, -1) for name in _WIDTHS for part in columns[name]]
    return np.concatenate(parts, axis=2).reshape(len(one), -1)
