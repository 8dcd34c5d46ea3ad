"""What drives a flow: velocities and forces that a result which may be zero by symmetry is compared with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fsi.case.walls import WallVelocity
from fsi.meshes.geometry.containers import Container
from fsi.periodic import CellDomain

if TYPE_CHECKING:
    from fsi.case.case import Case


@dataclass(frozen=True, slots=True)
class Drive:
    """How fast walls or a mean flow move the fluid past a body, and what that costs.

    velocity: rate of shear times the largest radius; resistance: force over velocity, mu in the plane and
    mu a for spheres.
    """

    velocity: float
    resistance: float


def drive_of(case: Case, t: float) -> Drive:
    """What walls and mean flow of a case do at time t.

    A wall shears at its speed over the size of the container.
    """
    radius = max((body.radius for body in case.bodies), default=0.0)
    container = case.container()
    rates = [_rate(wall, container) for wall in case.wall_velocity(t).values()]
    if isinstance(case.domain, CellDomain):
        rates += [abs(case.domain.shear), abs(case.domain.extension)]
    viscosity = case.fluid.viscosity
    return Drive(max(rates, default=0.0) * radius, viscosity * (radius if case.spheres else 1.0))


def _rate(wall: WallVelocity, container: Container) -> float:
    return float(np.linalg.norm(wall.velocity)) / container.size() + abs(wall.shear)
