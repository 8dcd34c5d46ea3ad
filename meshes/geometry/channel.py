"""The channel between two plane walls, `bottom` and `top`, that are periodic along themselves."""

from collections.abc import Mapping

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import Container

CHANNEL = ("bottom", "top")


def wall_heights(channel: Container) -> dict[str, float]:
    """Where the walls stand on the last axis."""
    return {name: channel.faces[name][1] for name in CHANNEL}


def gradient_between(channel: Container, velocities: Mapping[str, Array]) -> Array:
    """W, rows of du_i/dx_j, of the shear flow that the velocities (d,) of both walls drive, (d, d).

    `du_i/dx_d = (u_top - u_bottom)_i / H` along the walls; all others are zero.
    """
    heights = wall_heights(channel)
    low, high = (velocities[name][:-1] for name in CHANNEL)
    W = np.zeros((channel.dimension, channel.dimension))
    W[:-1, -1] = (high - low) / (heights["top"] - heights["bottom"])
    return W
