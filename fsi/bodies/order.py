"""How bodies that are longer than wide are aligned, and how fast they turn.

    S = |< exp(2 i theta) >|,        tumbling rate  < omega >

with theta the angle of the long axis, that of the largest second moment of area, and omega counterclockwise:
S = 1 where all are parallel, 0 where no direction is preferred (the order of nematics in the plane).
"""

from __future__ import annotations

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration


def order_columns(q: Configuration, U: Array) -> dict[str, float]:
    """S and the mean omega of the bodies with a long axis, where there are two or more.

    Args:
        q: bodies in the plane; of discs there is nothing to say.
        U: their velocities, (N, 3).
    """
    axes = [(i, outline.long_axis) for i, outline in enumerate(q.outlines)]
    long = [(i, axis) for i, axis in axes if axis is not None]
    if len(long) < 2:
        return {}
    bodies = [i for i, _ in long]
    theta = q.angles[bodies] + np.array([axis for _, axis in long])
    order = float(np.abs(np.exp(2.0j * theta).mean()))
    return {"order_parameter": order, "tumbling_rate": float(U[bodies, 2].mean())}
