"""Unit normals of the walls, into the fluid: the gradients of a container's distances."""

from __future__ import annotations

import numpy as np

from fsi.bodies.configuration import Array
from fsi.meshes.geometry.containers import Container


def inward_normals(container: Container, x: Array) -> Array:
    """The gradient at points x (n, d) of the distance to each wall, a unit vector, shape (n, walls, d).

    Walls are told apart by name, as containers name them: flat ones stand across an axis, `far` is an arc
    or a sphere around the origin.
    """
    n, d = x.shape
    normals = np.empty((n, len(container.walls), d))
    flat = _flat_normals(d)
    for k, wall in enumerate(container.walls):
        if wall == "far":
            length = np.linalg.norm(x, axis=1, keepdims=True)
            normals[:, k] = -x / np.where(
                length > 0.0, length, 1.0
            )  # in the centre every direction is as good
        else:
            normals[:, k] = flat[wall]
    return normals


def _flat_normals(d: int) -> dict[str, Array]:
    """Of the walls that stand across an axis; bottom, top and plane across the last, y or z."""
    e = np.eye(d)
    normals = {"left": e[0], "right": -e[0], "bottom": e[-1], "top": -e[-1], "plane": e[-1]}
    return normals | ({"front": e[1], "back": -e[1]} if d == 3 else {})
