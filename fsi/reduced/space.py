"""What surrounds the bodies of the reduced model: walls, periods, the flow far from every body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.bodies import Array
from meshes.geometry import Box, Container, HalfPlane

# The rotation of the flow u = E x is the antisymmetric part of E: d = 2 has the mode omega, d = 3 three of
# them.
_SPINS = {2: ((1, 0),), 3: ((2, 1), (0, 2), (1, 0))}


@dataclass(frozen=True, slots=True)
class Space:
    """The room of the bodies at one instant, in d dimensions.

    container: its walls; wall_velocity: (walls, d); periods: lattice vectors as rows, (k, d), k = 0 to d;
    mean: u_0 and gradient: E, rows of (du_i / dx_j), of the background flow `u_inf = u_0 + E x`, relative to
    which bodies are dragged and with which a lattice is carried along.
    """

    container: Container
    wall_velocity: Array
    periods: Array
    mean: Array
    gradient: Array

    def background(self, x: Array) -> Array:
        """`u_inf` and its rate of rotation in all modes at points (n, d), shape (n, modes)."""
        E = self.gradient
        spins = [0.5 * (E[i, j] - E[j, i]) for i, j in _SPINS[len(E)]]
        return np.column_stack([self.mean + x @ E.T, np.broadcast_to(spins, (len(x), len(spins)))])


@dataclass(frozen=True, slots=True)
class WallGaps:
    """All pairs of a body and a wall that it can touch; shapes (N, W) and for normals (N, W, d).

    gap: D; normal: from the wall into the fluid; radius: the reduced radius a_r; curvature: of the gap along
    the wall, 0 for a plane one; lubricates: shape (W,).
    """

    gap: Array
    normal: Array
    radius: Array
    curvature: Array
    lubricates: NDArray[np.bool_]


def wall_gaps(container: Container, centres: Array, radii: Array) -> WallGaps:
    """Gaps between bodies (N, d) and walls.

    A plane wall has a_r = a. Seen from inside, a round wall of radius R has a_r = a R/(R - a). The arc of a
    half-plane stands for infinity and lubricates nothing.
    """
    gap = container.distances(centres) - radii[:, None]
    bodies, walls = gap.shape
    lubricates = np.ones(walls, dtype=bool)
    radius = np.repeat(radii[:, None], walls, axis=1)
    curvature = np.zeros((bodies, walls))
    normal = np.zeros((bodies, walls, centres.shape[1]))
    if isinstance(container, Box):
        normal[:] = _box_normals(container, centres.shape[1])
    elif isinstance(container, HalfPlane):
        normal[:, 0, -1] = 1.0
        lubricates[1] = False
    elif walls:
        distance = np.linalg.norm(centres, axis=1)
        normal[:, 0] = -centres / np.where(distance > 0.0, distance, 1.0)[:, None]
        curvature[:, 0] = -1.0 / np.where(distance > 0.0, distance, 1.0)
        outer = 0.5 * container.size()
        radius = (radii * outer / (outer - radii))[:, None]
    return WallGaps(gap, normal, radius, curvature, lubricates)


def _box_normals(box: Container, dimension: int) -> Array:
    """Unit normals into the box of its walls, (W, d): of one axis after the other, low side and high side."""
    names = {"left": (0, 1.0), "right": (0, -1.0), "bottom": (-1, 1.0), "top": (-1, -1.0)}
    names |= {"front": (1, 1.0), "back": (1, -1.0)}
    normals = np.zeros((len(box.walls), dimension))
    for row, wall in zip(normals, box.walls, strict=True):
        axis, sign = names[wall]
        row[axis] = sign
    return normals
