"""What holds on the walls and on the bodies of a case, and where walls make the flow singular."""

import numpy as np

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.meshes.geometry.reentrant import reentrant_corners
from fsi.stokes.corners import bends_anew, singular
from fsi.stokes.problem import Boundary, Field, SurfaceConditions


def boundary_of(case: Case, t: float) -> Boundary:
    """What holds on the walls of a case at time t."""
    velocities: dict[str, Field] = {wall: given.at for wall, given in case.wall_velocity(t).items()}
    stresses = case.wall_stress(t)
    velocities |= dict.fromkeys(stresses, np.zeros_like)  # what they drive comes on top
    return Boundary(
        velocities, case.wall_pressure(), None, *case.domain.mean_drive(), stresses, case.wall_slip()
    )


def surfaces_of(case: Case) -> SurfaceConditions:
    """The surfaces of its bodies."""
    lengths = {i: body.slip_length for i, body in enumerate(case.bodies) if body.slip_length}
    modes = {i: np.array(body.surface_velocity) for i, body in enumerate(case.bodies) if body.swims}
    return SurfaceConditions(lengths, modes)


def wall_kinks(case: Case) -> set[float]:
    """The times between which the velocities of the walls are linear, at least one."""
    return set[float]().union(*(wall.kinks() for wall in case.domain.walls.values())) or {0.0}


def singular_pairs(case: Case) -> tuple[tuple[int, int], ...]:
    """The pairs of walls where the flow is singular at some time: walls are linear between their kinks."""
    container = case.container()
    return tuple(
        sorted({pair for t in wall_kinks(case) for pair in singular(container, boundary_of(case, t))})
    )


def singular_corners(case: Case) -> Array:
    """Where in the plane these walls meet, re-entrant corners, and where one that slips bends anew, (n, 2).

    Where fluid sticks to such a wall the flow is singular too, u ~ r^2 ln r, of which two degrees on one mesh
    tell. With any of the former errors are told by two meshes, and these have small cells there as well.
    """
    container, slips = case.container(), case.wall_slip()
    meetings, pairs = container.meetings(), singular_pairs(case)
    bends = {wall: bends_anew(container, k) for k, wall in enumerate(container.walls)}
    reentrant = reentrant_corners(container)
    if not pairs and not len(reentrant) and not any(len(bends[wall]) for wall in slips):
        return np.empty((0, 2))
    return np.concatenate([*(meetings[pair] for pair in pairs), reentrant, *bends.values()])
