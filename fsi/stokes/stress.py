"""Wall stress, dissipation and bulk stress of a periodic flow: three ways to one apparent viscosity.

With E the mean strain rate (in a channel that of its walls, gammadot = (u_top - u_bottom) / H),

    wall stress    sigma_xy = (force on the top wall - force on the bottom wall) / 2 L
    bulk stress    Sigma = 1/|Omega| (int_fluid sigma + sum_i S_i - sum_pairs r (x) F),
                   int_fluid 2 mu e = 2 mu E |Omega|
    dissipation    int 2 mu e:e = |Omega| Sigma:E                     without any other power

For bodies without force and torque the three agree: the discrete flow satisfies each equality to rounding, as
y e_x and E x are functions of the space of u. And since the mean of e over the fluid is E |Omega| / |fluid|,

    mu_app / mu >= 1 / (1 - phi)                                      (Cauchy and Schwarz).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from mpi4py import MPI

from fsi.bodies.configuration import Array, Configuration
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.geometry.periodic import Cell, Channel, Periodic
from fsi.observables.bulk_stress import BulkStress, area_fraction
from fsi.stokes.discretisation.boundary import BoundaryNodes
from fsi.stokes.solvers.elimination import NodalSolution, System


def bulk_stress(
    system: System, nodes: BoundaryNodes, solution: NodalSolution, container: Periodic, q: Configuration,
    strain_rate: Array, mean_pressure: float, viscosity: float, interaction: Array,
) -> BulkStress:  # fmt: skip
    """Sigma and its parts; collective.

    Args:
        system: what was solved.
        nodes: velocity nodes.
        solution: nodal values and reactions.
        container: the periodic domain.
        q: the bodies.
        strain_rate: E, symmetric, (2, 2).
        mean_pressure: of the nodal values in the fluid; Sigma is that of a flow where it is zero.
        viscosity: mu.
        interaction: sum of r (x) F of the forces between bodies, (2, 2).
    """
    shares = system.shares
    viscous = _viscous_part(system, nodes.x, solution) / container.volume
    fluid = np.array([[viscous[0], viscous[1]], [viscous[1], viscous[2]]])
    r = nodes.x[shares.on_body // 2] - q.centres[shares.body]
    lattice = Lattice(container.periods)
    r -= lattice.shift(lattice.nearest(r))
    moments = np.zeros((len(q), 2, 2))
    component = shares.on_body % 2
    for i in range(2):
        np.add.at(moments[:, i], (shares.body, component), r[:, i] * solution.reaction[shares.on_body])
    shares.comm.Allreduce(MPI.IN_PLACE, moments)
    of_pressure = mean_pressure * np.pi * q.radii[:, None, None] ** 2 * np.eye(2)
    S = of_pressure - 0.5 * (moments + moments.swapaxes(1, 2))
    rate = float(np.sum(strain_rate**2))
    bulk = BulkStress(fluid, S, 0.0 - interaction / container.volume, container.volume, None)
    if rate == 0.0:
        return bulk
    stress = _wall_stress(system, nodes, solution, container)
    power = np.sum(bulk.mean * strain_rate) if stress is None else 2.0 * stress * strain_rate[0, 1]
    return replace(bulk, apparent_viscosity=float(power / (2.0 * viscosity * rate)))


def _viscous_part(system: System, x: Array, solution: NodalSolution) -> Array:
    """The components xx, xy, yy of int 2 mu e over the fluid, (3,).

    int 2 mu e:D = D x . A u, where A u = b + lambda - B^T p, and D x . B^T p = - tr D int p. Slaves and their
    masters, with opposite lambda, count by how far they are apart.
    """
    shares = system.shares
    moments = _moments(x, system.b[: shares.velocities])
    at = x.copy()
    on_side = shares.slave < shares.velocities
    at[shares.slave[on_side] // 2] = shares.away[on_side]
    moments += _moments(at, solution.reaction[: shares.velocities])
    moments[[0, 2]] += float(system.weights @ solution.x[shares.velocities :])
    shares.comm.Allreduce(MPI.IN_PLACE, moments)
    return moments


def _moments(x: Array, nodal: Array) -> Array:
    """The components xx, xy, yy of sym x (x) f summed over nodes x (n, 2), for their forces f."""
    f = nodal.reshape(-1, 2)
    return np.array([x[:, 0] @ f[:, 0], 0.5 * (x[:, 1] @ f[:, 0] + x[:, 0] @ f[:, 1]), x[:, 1] @ f[:, 1]])


def _wall_stress(
    system: System, nodes: BoundaryNodes, solution: NodalSolution, container: Periodic
) -> float | None:
    """Shear stress on the walls of a channel, the mean of both; None in a cell without walls."""
    if isinstance(container, Cell):
        return None
    force: dict[str, float] = {
        wall: system.shares.comm.allreduce(float(solution.reaction[2 * node.astype(np.int64)].sum()))
        for wall, node in nodes.wall_nodes.items()
    }
    return (force["top"] - force["bottom"]) / (2.0 * float(container.periods[0, 0]))


def strain_rate(container: Periodic, walls: Mapping[str, Callable[[Array], Array]]) -> Array:
    """E, symmetric, (2, 2); zero in a channel whose walls have no given velocity. walls: u(x) on them."""
    if isinstance(container, Cell):
        gradient: Array = np.array(container.gradient)
        symmetric: Array = 0.5 * (gradient + gradient.T)
        return symmetric
    E = np.zeros((2, 2))
    if len(walls) == 2:
        bottom, top = (walls[wall](np.array([corner]))[0, 0] for wall, corner in _corners(container))
        E[0, 1] = E[1, 0] = 0.5 * (top - bottom) / (container.upper[1] - container.lower[1])
    return E


def _corners(container: Channel) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """A point on each wall."""
    return ("bottom", container.lower), ("top", container.upper)


def is_force_free(system: System) -> bool:
    """Whether walls or the mean flow alone do work on bodies that move as they are carried; collective."""
    motion = system.motion
    loaded = system.shares.comm.allreduce(bool(system.b.any()), op=MPI.LOR)
    return not (motion.held.any() or motion.F.any() or loaded or system.inertia is not None)


# The checks below; they apply only at instants with a strain rate and without loads on bodies.
VISCOSITY_CHECKS = ("stress", "viscosity_bound")


def viscosity_checks(
    bulk: BulkStress, strain_rate: Array, dissipation: float, viscosity: float, q: Configuration
) -> Mapping[str, float]:
    """Relative defects of the equalities and of the bound, for bodies without force and torque."""
    if bulk.apparent_viscosity is None:
        return {}
    scale = 2.0 * viscosity * float(np.sum(strain_rate**2))
    by_bulk = float(np.sum(bulk.mean * strain_rate)) / scale
    imposed = (2.0 * viscosity * strain_rate + bulk.stresslets.sum(axis=0) / bulk.area) * strain_rate
    by_dissipation, mu = dissipation / (scale * bulk.area), bulk.apparent_viscosity
    others = np.array([by_bulk, float(imposed.sum()) / scale, by_dissipation])
    bound = 1.0 / (1.0 - area_fraction(q.radii, bulk.area))
    return {
        "stress": float(np.abs(others / mu - 1.0).max()),
        "viscosity_bound": max(0.0, bound / mu - 1.0),
    }
