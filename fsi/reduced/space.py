"""What surrounds the bodies of the reduced model: walls, periods, the flow far from every body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.meshes.geometry.containers import Container, HalfPlane, Round, lengths
from fsi.normals import inward_normals

# The rotation of the flow u = E x is the antisymmetric part of E: d = 2 has the mode omega, d = 3 three of
# them.
_SPINS = {2: ((1, 0),), 3: ((2, 1), (0, 2), (1, 0))}


@dataclass(frozen=True, slots=True)
class Space:
    """The room of the bodies at one instant, in d dimensions.

    container: its walls and periods; solid: which walls are, the others being open; wall_velocity: (walls,
    d); mean: u_0 and gradient: E, rows of (du_i / dx_j), of the background flow `u_inf = u_0 + E x`, relative
    to which bodies are dragged and with which a lattice is carried along.
    """

    container: Container
    solid: NDArray[np.bool_]
    wall_velocity: Array
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
    radius = np.repeat(radii[:, None], gap.shape[1], axis=1)
    curvature = np.zeros_like(gap)
    lubricates = np.ones(gap.shape[1], dtype=bool)
    if isinstance(container, HalfPlane):
        lubricates[1] = False
    elif isinstance(container, Round):
        distance, outer = lengths(centres), container.radius
        curvature[:, 0] = -1.0 / np.where(distance > 0.0, distance, 1.0)
        radius[:, 0] = radii * outer / (outer - radii)
    return WallGaps(gap, inward_normals(container, centres), radius, curvature, lubricates)
