"""The numbers of each pore of which its points and trial functions are made, for compiled loops.

One array of complex numbers, since every array more makes machine code longer to make: places and vectors are
x + i y, other numbers real parts.
"""

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.pores.regions import NEXT, OTHER, PoreShapes
from fsi.pores.surfaces import CONTAINER, WALL

type Complex = NDArray[np.complex128]

# The columns, of each vertex v, or of side v opposite.
(
    IS_WALL,  # 1 of a wall, 0 of a circle
    SIGN,  # -1 of a container, 1 else
    CENTRE,
    RADIUS,  # 1 of a wall
    NORMAL,  # 0 of circles
    REFERENCE,  # where psi of the surface is its number c
    TOUCH,  # where the inscribed circle touches
    FIRST,  # foot of the neck
    SECOND,
    DIRECTION,  # of the neck; 0 in the corner of a box
    GAP,
    GATHERING,  # T of the strip
    LINE,  # gradient of e_v, 1 over its height; 0 in a corner, where nothing has to vanish and e_v is 1
    IS_CORNER,  # 1 there, 0 else
    ACROSS,  # gradient of what modes call e / D
    TURN,  # +1 where the side runs as its neck is directed, -1 against it
    MIDDLE,  # of the points of touching
    SIZE,  # distance of the farthest of them from there
) = range(18)


def pore_data(shapes: PoreShapes) -> Complex:
    """All columns, (n, 3, .)."""
    wall, corner = shapes.kind == WALL, shapes.gap <= 0.0
    n, touch = planar(shapes.direction), planar(shapes.touch)
    first, second = planar(shapes.foot[:, :, 0]), planar(shapes.foot[:, :, 1])
    upright = 1j * n
    height = np.where(corner, 1.0, (upright.conj() * (touch - first)).real)
    middle = np.broadcast_to(touch.mean(axis=1)[:, None], touch.shape)
    columns = {
        IS_WALL: wall,
        SIGN: np.where(shapes.kind == CONTAINER, -1.0, 1.0),
        CENTRE: planar(shapes.centre),
        RADIUS: np.where(wall, 1.0, shapes.radius),
        NORMAL: planar(shapes.normal),
        REFERENCE: planar(shapes.reference),
        TOUCH: touch,
        FIRST: first,
        SECOND: second,
        DIRECTION: n,
        GAP: shapes.gap,
        GATHERING: gathering(shapes),
        LINE: upright / height,
        IS_CORNER: corner,
        ACROSS: upright / np.where(corner, 1.0, shapes.reach),
        TURN: shapes.turn,
        MIDDLE: middle,
        SIZE: np.abs(touch - middle).max(axis=1)[:, None],
    }
    data = np.empty((*shapes.gap.shape, len(columns)), complex)
    for column, values in columns.items():
        data[..., column] = values
    return data


def planar(x: Array) -> Complex:
    """Vectors (..., 2) as complex numbers."""
    return np.asarray(x[..., 0] + 1j * x[..., 1])


def gathering(shapes: PoreShapes) -> Array:
    """T of all sides, arcsinh(span / sqrt(2 gap / (1/a_i + 1/a_j))), (n, 3)."""
    sign = np.where(shapes.kind == CONTAINER, -1.0, 1.0)
    bent = np.where(shapes.kind == WALL, 0.0, sign / np.where(shapes.radius > 0.0, shapes.radius, 1.0))
    curvature = bent[:, NEXT] + bent[:, OTHER]
    arms = shapes.touch[:, [NEXT, OTHER]].swapaxes(1, 2) - shapes.foot
    span = 0.5 * np.linalg.norm(arms, axis=3).sum(axis=2)
    gap = np.where(shapes.gap > 0.0, shapes.gap, np.inf)  # a corner of two walls
    T: Array = np.arcsinh(span * np.sqrt(0.5 * np.maximum(curvature, 0.0) / gap))
    return T
