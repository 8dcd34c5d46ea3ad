"""Where walls meet with data that do not fit: the flow in such a corner is singular.

In polar coordinates around a right angle between

- walls with different velocities the flow is u ~ r^0, and pressure and shear go like 1 / r (Taylor 1962). The
  dissipation 2 mu e : e ~ 1 / r^2 has no integral: it is infinite, like the force that moves such a wall.
- a wall with a given velocity and an open one it is u ~ r^0.59; the dissipation is finite.

A force on a body between the walls is finite with both: meshes are graded towards these corners
(`fsi.meshes.planar.grading`).
"""

import numpy as np

from fsi.bodies.configuration import Array
from fsi.meshes.geometry.container import Container
from fsi.stokes.problem import Boundary

SAME = 1e-12  # velocities that differ by this part of the largest are one


def jumps(container: Container, boundary: Boundary) -> list[tuple[int, int]]:
    """The pairs of walls whose given velocities differ where they meet."""
    velocities = [boundary.velocities.get(wall) for wall in container.walls]
    found = []
    for (one, other), x in container.meetings().items():
        u, v = velocities[one], velocities[other]
        if u is not None and v is not None:
            here, there = u(x), v(x)
            if np.abs(here - there).max() > SAME * max(np.abs(here).max(), np.abs(there).max()):
                found.append((one, other))
    return found


def singular(container: Container, boundary: Boundary) -> list[tuple[int, int]]:
    """The pairs of walls that meet in corners where the flow is singular."""
    is_open = [wall in boundary.pressures for wall in container.walls]
    mixed = [(one, other) for one, other in container.meetings() if is_open[one] != is_open[other]]
    return jumps(container, boundary) + mixed


def distance(container: Container, pairs: list[tuple[int, int]], x: Array) -> Array:
    """Of points (n, d) from where pairs of walls meet at right angles, (n,); infinite without pairs."""
    to_walls = container.distances(x)
    to_each = [np.hypot(to_walls[:, one], to_walls[:, other]) for one, other in pairs]
    nearest: Array = np.min(to_each, axis=0, initial=np.inf) if pairs else np.full(len(x), np.inf)
    return nearest
