"""A case as the reduced model sees it: drag, walls, background flow."""

from __future__ import annotations

import numpy as np

from fsi.bodies.configuration import Array
from fsi.case.background_flow import background
from fsi.case.case import Case
from fsi.reduced.space import Space


def drag(case: Case) -> Array:
    """The drag coefficients zeta of lone bodies, (N, modes).

    Translation: `reduced.drag` times mu a for spheres, mu for discs; rotation: 8 pi mu a^3 of a sphere, 4 pi
    mu a^2 of a disc per unit length, the exact ones in unbounded fluid.
    """
    mu, q = case.fluid.viscosity, case.configuration()
    modes, d = case.motion(0.0).U.shape[1], q.centres.shape[1]
    scale = mu * q.radii if case.spheres else np.full(len(q), mu)
    turning = 8.0 * np.pi * mu * q.radii**3 if case.spheres else 4.0 * np.pi * mu * q.radii**2
    return np.column_stack([case.drag * scale] * d + [turning] * (modes - d))


def make_space(case: Case, t: float, d: int) -> Space:
    """Walls, periods and background flow of a case in d dimensions at time t."""
    container, walls = case.container().at(t), case.wall_velocity(t)
    velocity = np.zeros((len(container.walls), d))
    for row, name in zip(velocity, container.walls, strict=True):
        if name in walls:
            row[:] = walls[name].velocity
    solid = np.array([name in walls for name in container.walls], dtype=bool)
    return Space(container, solid, velocity, *background(container, walls))
