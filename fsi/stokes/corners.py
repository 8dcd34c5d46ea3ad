"""Where walls meet with data that do not fit: the flow in such a corner is singular.

In polar coordinates around a right angle between

- walls with different velocities the flow is u ~ r^0, and pressure and shear go like 1 / r (Taylor 1962). The
  dissipation 2 mu e : e ~ 1 / r^2 has no integral: it is infinite, like the force that moves such a wall.
- a wall with a given velocity and an open one it is u ~ r^0.59; the dissipation is finite.
- a wall along which fluid slides with a slip length b and an open one the shear traction jumps from
  -(mu / b) u to 0, and u ~ r ln r.

Where fluid slides along a wall only the normal component there is given: a lid that slides past walls at rest
does not jump. Beside a wall without friction the flow is that of twice the angle, a plane wall, and friction
is of lower order: what slides makes no corner singular with a wall to which fluid sticks and that moves as it
does. Where the two move otherwise, with velocities that differ by U along the former, the traction (mu / b) U
ends in the corner: u ~ r ln r there too.

Where the curvature kappa of such a wall jumps, as at the ends of a wave, so does the vorticity
(2 kappa + 1/b) u along it, its harmonic conjugate p goes like ln r, and u ~ r ln r again.

In a corner of an angle A above pi the flow is singular with any data: between walls to which fluid sticks it
is u ~ r^z with the least root of sin(z A) = -z sin A, 0.54 for A = 3 pi/2 (Moffatt 1964).

A force on a body between the walls is finite with all: meshes are graded towards these corners
(`fsi.meshes.planar.grading`).
"""

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.curves import WallCurve
from fsi.stokes.problem import Boundary

SAME = 1e-12  # velocities that differ by this part of the largest are one


def jumps(container: Container, boundary: Boundary) -> list[tuple[int, int]]:
    """The pairs of walls whose given velocities differ where they meet."""
    velocities = [boundary.velocities.get(wall) for wall in container.walls]
    given = _given(container, boundary)
    found = []
    for (one, other), x in container.meetings().items():
        u, v = velocities[one], velocities[other]
        if u is not None and v is not None:
            both = given[one] & given[other]
            here, there = u(x)[:, both], v(x)[:, both]
            if not both.any():
                continue
            if np.abs(here - there).max() > SAME * max(np.abs(here).max(), np.abs(there).max()):
                found.append((one, other))
    return found


def _given(container: Container, boundary: Boundary) -> NDArray[np.bool_]:
    """Which components of the velocity each wall gives at its corners, (walls, d)."""
    given = np.ones((len(container.walls), container.dimension), dtype=bool)
    for k, wall in enumerate(container.walls):
        if wall in boundary.slip_lengths:
            given[k] = np.arange(container.dimension) == container.corner_axes[k]
    return given


def singular(container: Container, boundary: Boundary) -> list[tuple[int, int]]:
    """The pairs of walls that meet in corners where the flow is singular."""
    is_open = [wall in boundary.pressures for wall in container.walls]
    mixed = [(one, other) for one, other in container.meetings() if is_open[one] != is_open[other]]
    jumping = jumps(container, boundary)
    slid = [pair for pair in _slid(container, boundary) if pair not in jumping]
    return jumping + slid + mixed


def _slid(container: Container, boundary: Boundary) -> list[tuple[int, int]]:
    """The pairs of walls of the plane that move otherwise where they meet, while fluid slides along one."""
    found = []
    for (one, other), x in container.meetings().items():
        walls = [container.walls[one], container.walls[other]]
        u, v = (boundary.velocities.get(wall) for wall in walls)
        slides = container.dimension == 2 and any(wall in boundary.slip_lengths for wall in walls)
        if slides and u is not None and v is not None and np.abs(u(x) - v(x)).max() > 0.0:
            found.append((one, other))
    return found


def bends_anew(container: Container, wall: int) -> Array:
    """Where in the plane the curvature of a wall jumps, (n, 2): one piece of it ends and another begins."""
    pieces = [curve for curve in container.outline() if curve.wall == wall]
    begins, ends = (np.array([curve.ends[k] for curve in pieces]).reshape(-1, 2) for k in (0, 1))
    meet = np.linalg.norm(ends[:, None] - begins, axis=2) <= SAME * container.size()
    unlike = [i for i, j in np.argwhere(meet).tolist() if not _alike(pieces[i], pieces[j])]
    return np.asarray(ends[unlike])


def _alike(one: WallCurve, other: WallCurve) -> bool:
    """Whether two pieces are both straight, or both on one circle."""
    if one.solid is not None or other.solid is not None:
        return False
    if one.centre is None or other.centre is None:
        return one.centre is other.centre
    return bool(np.allclose(one.centre, other.centre, rtol=1e-9))


def distance(container: Container, pairs: list[tuple[int, int]], x: Array) -> Array:
    """Of points (n, d) from where pairs of walls meet at right angles, (n,); infinite without pairs."""
    to_walls = container.distances(x)
    to_each = [np.hypot(to_walls[:, one], to_walls[:, other]) for one, other in pairs]
    nearest: Array = np.min(to_each, axis=0, initial=np.inf) if pairs else np.full(len(x), np.inf)
    return nearest
