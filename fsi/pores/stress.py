"""The mean stress of a periodic domain in the model of pores, which has no pressure: its deviator.

    Sigma' = 2 mu E + 1/|Omega| (sum_i S_i)' + forces'

with E the mean strain rate, S_i the stresslets and `forces` what forces between bodies carry (see
`fsi.observables.bulk_stress`). In a cell the sides transmit

    Sigma_sides = 2 mu E + 1/|Omega| sum_i (S_i - sym q_i (x) F_i)

by the power that a mean strain rate has, with the loads F_i on bodies at q_i. The apparent viscosity is
Sigma:E / (2 mu E:E). In a channel it is by the forces on the walls, and the rest of the stress is not known,
as walls that take part in a strain do not move as rigid bodies do.
"""

from math import nan

import numpy as np

from fsi.bodies.configuration import Array
from fsi.observables.bars import DrivenBodies
from fsi.observables.bulk_stress import DeviatoricStress, area_fraction
from fsi.pores.solve import PoreFlow


def mean_strain_rate(bodies: DrivenBodies, walls: Array) -> Array:
    """E of a periodic flow, symmetric, (2, 2); between walls with velocities (W, 3) that of their slip."""
    container = bodies.case.container()
    E: Array = 0.5 * (container.mean_gradient + container.mean_gradient.T)
    if len(container.walls) == 2:
        bottom, top = (container.walls.index(name) for name in ("bottom", "top"))
        height = float(container.distances(container.middle[None])[0].sum())
        E[0, 1] = E[1, 0] = 0.5 * (walls[top, 0] - walls[bottom, 0]) / height
    return E


def deviatoric_stress(bodies: DrivenBodies, flow: PoreFlow) -> DeviatoricStress | None:
    """The mean stress of a periodic domain; None elsewhere."""
    case, container = bodies.case, bodies.case.container()
    if not len(container.periods):
        return None
    E, mu = mean_strain_rate(bodies, flow.loading.walls), case.fluid.viscosity
    rate = 2.0 * mu * float(np.sum(E**2))
    if container.walls:
        bottom, top = (container.walls.index(name) for name in ("bottom", "top"))
        force = flow.wall_forces[top, 0] - flow.wall_forces[bottom, 0]
        power = force / float(container.periods[0, 0]) * E[0, 1]
        return DeviatoricStress(None, float(power) / rate if rate else None)
    moment = bodies.q.centres.T @ flow.F[:, :2] - case.interaction_moment(bodies.q, bodies.t)
    carried = 0.5 * (moment + moment.T) / container.volume
    mean = flow.mean_stress() + carried - 0.5 * np.trace(carried) * np.eye(2)
    return DeviatoricStress(mean, float(np.sum(mean * E)) / rate if rate else None)


VISCOSITY_CHECKS = ("stress", "viscosity_bound")


def viscosity_checks(bodies: DrivenBodies, flow: PoreFlow, stress: DeviatoricStress) -> dict[str, float]:
    """Of bodies without loads: the viscosity by stress is that by dissipation, and at least 1 / (1 - phi)."""
    mu, volume = stress.apparent_viscosity, bodies.case.container().volume
    if mu is None or not is_force_free(bodies, flow):
        return dict.fromkeys(VISCOSITY_CHECKS, nan)
    E = mean_strain_rate(bodies, flow.loading.walls)
    by_dissipation = flow.dissipation / (2.0 * bodies.case.fluid.viscosity * float(np.sum(E**2)) * volume)
    bound = 1.0 / (1.0 - area_fraction(bodies.q.radii, volume))
    defects = abs(by_dissipation / mu - 1.0), max(0.0, bound / mu - 1.0)
    return dict(zip(VISCOSITY_CHECKS, defects, strict=True))


def is_force_free(bodies: DrivenBodies, flow: PoreFlow) -> bool:
    """Whether walls or the mean flow alone do work, on bodies that move as they are carried."""
    loading = flow.loading
    pushed = bodies.case.interaction_moment(bodies.q, bodies.t).any() or loading.inertia is not None
    driven = loading.pressure_gradient != 0.0  # None where the flux is given
    return not (bodies.motion.held.any() or bodies.motion.F.any() or pushed or driven)
