"""Wall stress, dissipation and bulk stress of a periodic flow: three ways to one apparent viscosity.

With E the mean strain rate (in a channel that of its walls, gammadot = (u_top - u_bottom) / H),

    wall stress    sigma_xy = (force on the top wall - force on the bottom wall) / 2 L,   in space / 2 L_x L_y
    bulk stress    Sigma = 1/|Omega| (int_fluid sigma + sum_i S_i - sum_pairs r (x) F),
                   int_fluid 2 mu e = 2 mu E |Omega|
    dissipation    int 2 mu e:e = |Omega| Sigma:E                     without any other power, with friction

With laws below a gap walls and S have their parts, and the power of the walls that of carrying bodies past
where they are meshed. For bodies without force and torque the three agree: the discrete flow satisfies each
equality to rounding, as y e_x and E x are functions of the space of u. And since the mean of e over the fluid
is E |Omega| / |fluid|,

    mu_app / mu >= 1 / (1 - phi)                                      (Cauchy and Schwarz).
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from mpi4py import MPI

from fsi.arrays import Array
from fsi.observables.bulk_stress import BulkStress, compared_viscosities
from fsi.stokes.problem import StokesProblem, wall_area
from fsi.stokes.solvers.system import NodalSolution, StokesSystem, wall_force


def _with_level(in_gaps: Array, volumes: Array, volume: float) -> Array:
    """Of stresslets (N, d, d) what laws leave open, with the level of the pressure, whose mean is zero.

    Of a squeezed gap d of the plane the integral of p over it is 2 d F, the trace of what they leave open: so
    much less over all of the fluid presses on bodies of these volumes (N,) everywhere.
    """
    of_fluid = float(np.trace(in_gaps.sum(axis=0))) / (volume - float(volumes.sum()))
    return np.asarray(in_gaps + of_fluid * volumes[:, None, None] * np.eye(in_gaps.shape[1]))


def bulk_stress(system: StokesSystem, solution: NodalSolution, on_bodies: Array) -> BulkStress:
    """Sigma and its parts; collective.

    on_bodies: the reactions on bodies in the pressure that stresslets are to have, this rank's rows of u.
    """
    layout, problem, x = system.layout, system.problem, system.nodes.x
    q, volume, d = problem.q, problem.container.volume, layout.dimension
    fluid = _viscous_part(system, solution) / volume
    at = x[layout.on_body // d]
    r = at - q.centres[layout.body] - q.to_images(problem.fluid.lattice, layout.body, at)
    moments = np.zeros((len(q), d, d))
    for i in range(d):
        entries = (layout.body, layout.on_body % d)
        np.add.at(moments[:, i], entries, r[:, i] * on_bodies[layout.on_body])
    layout.comm.Allreduce(MPI.IN_PLACE, moments)
    S = -0.5 * (moments + moments.swapaxes(1, 2))
    laws, f = problem.laws, solution.law_forces
    if laws is not None:
        S += laws.stresslets(f, len(q))
    in_gaps = None if laws is None else _with_level(laws.in_gaps(f, len(q)), q.volumes, volume)
    carried = np.zeros((d, d)) if problem.interaction is None else 0.0 - problem.interaction / volume
    bulk = BulkStress(fluid, S, carried, volume, None, in_gaps=in_gaps)
    E = problem.mean_strain_rate
    if not E.any():
        return bulk
    power = float(np.sum(bulk.mean * E))
    if system.nodes.wall_nodes:  # in a channel by the mean shear stress on both walls
        names = problem.container.walls
        force = {wall: wall_force(system, solution.reaction, wall) for wall in system.nodes.wall_nodes}
        if laws is not None:
            force = {wall: of + laws.wall_force(f, names.index(wall)) for wall, of in force.items()}
        power = float((force["top"] - force["bottom"]) @ E[:-1, -1]) / wall_area(problem.container)
        if laws is not None:
            power += laws.carrying_power(f, solution.load) / volume
    alone = 2.0 * problem.viscosity * E
    return replace(bulk, apparent_viscosity=power / float(np.sum(alone * E)), newtonian=alone)


def _viscous_part(system: StokesSystem, solution: NodalSolution) -> Array:
    """`int 2 mu e` over the fluid, (d, d).

    int 2 mu e:D = D x . A u, where A u = b + lambda - B^T p, and D x . B^T p = - tr D int p. Slaves and their
    masters, with opposite lambda, count by how far they are apart.
    """
    layout, x = system.layout, system.nodes.x
    moments = _moments(x, system.b[: layout.velocities])
    at = x.copy()
    on_side = layout.slave < layout.velocities
    at[layout.slave[on_side] // layout.dimension] = layout.away[on_side]
    moments += _moments(at, solution.reaction[: layout.velocities])
    moments += float(system.weights @ solution.x[layout.velocities :]) * np.eye(layout.dimension)
    layout.comm.Allreduce(MPI.IN_PLACE, moments)
    return moments


def _moments(x: Array, nodal: Array) -> Array:
    """sym x (x) f summed over nodes x (n, d), for their forces f, (d, d)."""
    moments = np.array([[column @ f for f in nodal.reshape(x.shape).T] for column in x.T])
    return np.asarray(0.5 * (moments + moments.T))


def is_force_free(system: StokesSystem) -> bool:
    """Whether walls or the mean flow alone do work on bodies that move as they are carried; collective."""
    motion, problem = system.problem.motion, system.problem
    loaded = system.layout.comm.allreduce(bool(system.b.any()), op=MPI.LOR)
    pushed = problem.interaction is not None and problem.interaction.any()
    if problem.surfaces.swimming:
        return False
    return not (motion.held.any() or motion.F.any() or loaded or problem.inertia is not None or pushed)


def viscosity_checks(problem: StokesProblem, bulk: BulkStress, dissipation: float) -> Mapping[str, float]:
    """Relative defects of the equalities and of the bound, for bodies without force and torque.

    dissipation: with that of friction. Where fluid slides its mean strain rate is another one, and no bound
    is known.
    """
    if bulk.apparent_viscosity is None:
        return {}
    E, viscosity = problem.mean_strain_rate, problem.viscosity
    scale = 2.0 * viscosity * float(np.sum(E**2))
    by_bulk = float(np.sum(bulk.mean * E)) / scale
    imposed = (2.0 * viscosity * E + bulk.stresslets.sum(axis=0) / bulk.volume) * E
    by_dissipation, mu = dissipation / (scale * bulk.volume), bulk.apparent_viscosity
    if problem.sliding:
        return {"stress": max(abs(by_bulk / mu - 1.0), abs(by_dissipation / mu - 1.0))}
    others = [by_bulk, float(imposed.sum()) / scale, by_dissipation]
    return compared_viscosities(mu, others, float(problem.q.volumes.sum()) / bulk.volume)
