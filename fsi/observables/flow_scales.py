"""Scales of a flow, with which results that may be zero by symmetry are compared."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fsi.case.case import Case
from fsi.case.walls import WallVelocity
from fsi.meshes.geometry.containers import Container


@dataclass(frozen=True, slots=True)
class FlowScales:
    """How fast walls or a mean flow move the fluid past a body, and what that costs.

    Attributes:
        velocity: rate of shear times the largest radius.
        resistance: force over velocity, mu in the plane and mu a for spheres.
    """

    velocity: float
    resistance: float


def flow_scales(case: Case, t: float) -> FlowScales:
    """What walls and mean flow of a case do at time t.

    A wall shears at its speed over the size of the container.
    """
    radius = max((body.radius for body in case.bodies), default=0.0)
    container = case.container()
    rates = [_rate(wall, container) for wall in case.wall_velocity(t).values()]
    rate = max([*rates, float(np.abs(container.mean_gradient).max())])
    return FlowScales(rate * radius, case.fluid.viscosity * (radius if case.spheres else 1.0))


def _rate(wall: WallVelocity, container: Container) -> float:
    return float(np.linalg.norm(wall.velocity)) / container.size() + abs(wall.shear)
