"""The flow that a case would have without its bodies, where it is linear; and the walls that drive it."""

from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array
from fsi.case.background_flow import background
from fsi.errors import InputError
from fsi.postprocess.run.run import Run


@dataclass(frozen=True, slots=True, eq=False)
class UndisturbedFlow:
    """The flow `u_inf = u_0 + E x`.

    Attributes:
        velocity: u_0, (d,).
        gradient: E, rows of du_i / dx_j, (d, d).
    """

    velocity: Array
    gradient: Array

    @property
    def sheared(self) -> bool:
        """Whether it is more than a uniform flow."""
        return bool(self.gradient.any())

    def at(self, x: Array) -> Array:
        """The velocity at points (n, 3), z = 0 in the plane; (n, 3)."""
        d = len(self.velocity)
        u = np.zeros((len(x), 3))
        u[:, :d] = self.velocity + x[:, :d] @ self.gradient.T
        return u

    def stream_function(self, x: Array) -> Array:
        """Its stream function at points (n, 2) or (n, 3) of the plane, (n,), zero at the origin."""
        (a, b), E = self.velocity, self.gradient
        X, Y = x[:, 0], x[:, 1]
        psi: Array = a * Y - b * X + E[0, 0] * X * Y + 0.5 * (E[0, 1] * Y**2 - E[1, 0] * X**2)
        return psi


def undisturbed(run: Run, step: int) -> UndisturbedFlow | None:
    """That of a channel, of a cell, or far from bodies, at a step; None where none is linear."""
    case, container, t = run.case, run.container(step), run.time(step)
    walls = case.wall_velocity(t)
    if not (len(container.periods) or any(wall.gradient.any() for wall in walls.values())):
        return None
    try:
        return UndisturbedFlow(*background(container, walls))
    except InputError:
        return None


def is_sheared(run: Run) -> bool:
    """Whether bodies disturb a sheared flow, at the first step or the last."""
    if not run.case.bodies or not run.has("fluid"):
        return False
    flows = (undisturbed(run, int(step)) for step in run.times.index[[0, -1]])
    return any(flow is not None and flow.sheared for flow in flows)


@dataclass(frozen=True, slots=True, eq=False)
class MovingWall:
    """A plane wall that moves along itself, with one speed all over.

    Attributes:
        axis: the coordinate across it.
        place: that coordinate.
        outward: 1 where the fluid lies below it, else -1.
        speed: along the other coordinate, with its sign.
    """

    axis: int
    place: float
    outward: float
    speed: float


def sliding_walls(run: Run, step: int) -> list[MovingWall]:
    """Those of a box or channel in the plane at a step."""
    container, found = run.container(step), []
    walls = run.case.wall_velocity(run.time(step))
    for name, (axis, place) in container.faces.items():
        if (wall := walls.get(name)) is not None and wall.is_uniform_across(axis):
            speed = float(wall.at(place * np.eye(2)[axis])[1 - axis])
            outward = 1.0 if place > container.middle[axis] else -1.0
            found.append(MovingWall(axis, place, outward, speed))
    return [wall for wall in found if wall.speed]
