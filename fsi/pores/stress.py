"""The mean stress of a periodic domain in the model of pores, which have no pressure in bodies: its deviator.

    Sigma' = 1/|Omega| (int_fluid 2 mu e + sum_i S_i') + forces'

with S_i the stresslets and `forces` what forces between bodies carry (see `fsi.observables.bulk_stress`).
S_i : E' is minus the power that it takes to strain the surface of body i alone. Of bodies without loads three
ways lead to one apparent viscosity:

    by Sigma : E / (2 mu E : E), E the mean strain rate
    by the forces on the walls of a channel, by the power of a mean strain rate in a cell
    by the dissipation, |Omega| Sigma : E

They agree to rounding, since u = G x is one of the trial flows, where bodies are strained too. It also gives
the part of the fluid, which is 2 mu E but for errors of quadrature. Walls of a channel do not follow a flow
that is stretched along them: there xx and yy of this part are 0, as in truth.
"""

from dataclasses import replace
from math import nan

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.channel import gradient_between
from fsi.observables.bars import DrivenBodies
from fsi.observables.bulk_stress import (
    VISCOSITY_CHECKS,
    BulkStress,
    area_fraction,
    compared_viscosities,
    deviator,
)
from fsi.pores.carrier import carried
from fsi.pores.solve import PoreFlow, PoreLoading


def mean_strain_rate(bodies: DrivenBodies, loading: PoreLoading) -> Array:
    """E of a periodic flow, symmetric, (2, 2); between walls that of their slip."""
    container, W = bodies.case.container(), loading.gradient
    if len(container.walls) == 2:
        W = gradient_between(container, dict(zip(container.walls, loading.walls[:, :2], strict=True)))
    E: Array = 0.5 * (W + W.T)
    return E


def bulk_stress(bodies: DrivenBodies, flow: PoreFlow) -> BulkStress | None:
    """The mean stress of a periodic domain and its parts, less their traces; None elsewhere."""
    case, container = bodies.case, bodies.case.container()
    if not len(container.periods):
        return None
    E, mu = mean_strain_rate(bodies, flow.loading), case.fluid.viscosity
    volume, fluid = container.volume, _of_fluid(flow) / container.volume
    bulk = BulkStress(fluid, flow.stresslets, carried_stress(bodies), volume, None, pressure=False)
    if not E.any():
        return bulk
    power = float(np.sum(bulk.mean * E))
    if container.walls:
        force = dict(zip(container.walls, flow.wall_forces[:, 0], strict=True))
        power = float((force["top"] - force["bottom"]) / container.periods[0, 0] * E[0, 1])
    alone = 2.0 * mu * E
    return replace(bulk, apparent_viscosity=power / float(np.sum(alone * E)), newtonian=alone)


def carried_stress(bodies: DrivenBodies) -> Array:
    """What forces between bodies carry of the mean stress, (2, 2)."""
    case = bodies.case
    return deviator(-case.interaction_moment(bodies.q, bodies.t) / case.container().volume)


def viscous_stress(flow: PoreFlow, volume: float) -> Array:
    """The mean stress of a domain of that volume but for what forces between bodies carry, (2, 2)."""
    return np.asarray((_of_fluid(flow) + flow.stresslets.sum(axis=0)) / volume)


def _of_fluid(flow: PoreFlow) -> Array:
    """int 2 mu e over the fluid, (2, 2), by the power of linear flows."""
    xy, xx = _power_of(flow, np.array([[0.0, 1.0], [0.0, 0.0]])), 0.0
    if not len(flow.loading.walls):
        xx = 0.5 * _power_of(flow, np.diag([1.0, -1.0]))
    return np.array([[xx, xy], [xy, -xx]])


def _power_of(flow: PoreFlow, G: Array) -> float:
    """int 2 mu e : G over the fluid, by the power of u = G x, seen from each pore: far away no digits cancel.

    Bodies are carried along; they turn and strain besides.
    """
    system, E, t = flow.system, 0.5 * (G + G.T), np.zeros(flow.system.size)
    a, first = system.pores.surfaces.radius[: system.bodies], system.assembly.numbering.surface
    t[first[: system.bodies] + 2] = 0.5 * (G[1, 0] - G[0, 1])
    t[system.strains] = 0.5 * a[:, None] ** 2 * np.array([-E[0, 1], E[0, 0]])
    return float(t @ flow.reactions) + flow.power_of(lambda batch: carried(system, batch, G))


def viscosity_checks(bodies: DrivenBodies, flow: PoreFlow, stress: BulkStress) -> dict[str, float]:
    """Of bodies without loads: the three viscosities are one, and that at least 1 / (1 - phi)."""
    mu, volume = stress.apparent_viscosity, bodies.case.container().volume
    if mu is None or not is_force_free(bodies, flow):
        return dict.fromkeys(VISCOSITY_CHECKS, nan)
    E = mean_strain_rate(bodies, flow.loading)
    scale = 2.0 * bodies.case.fluid.viscosity * float(np.sum(E**2))
    others = [float(np.sum(stress.mean * E)) / scale, flow.dissipation / (scale * volume)]
    if not flow.loading.walls.size:
        others.append(flow.power_of_mean(E) / (scale * volume))
    return compared_viscosities(mu, others, area_fraction(bodies.q.radii, volume))


def is_force_free(bodies: DrivenBodies, flow: PoreFlow) -> bool:
    """Whether walls or the mean flow alone do work, on bodies that move as they are carried."""
    loading = flow.loading
    pushed = bodies.case.interaction_moment(bodies.q, bodies.t).any() or loading.inertia is not None
    driven = loading.pressure_gradient != 0.0  # None where the flux is given
    return not (bodies.motion.held.any() or bodies.motion.F.any() or pushed or driven)
