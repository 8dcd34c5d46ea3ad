"""From nodal values to a solution: loads, checks, mean stress, and what output needs of the flow."""

from __future__ import annotations

import numpy as np

from fsi.bodies.configuration import Array
from fsi.stokes.clock import Clock
from fsi.stokes.discretisation.boundary import facets_with
from fsi.stokes.fields import flow, traction
from fsi.stokes.identities import identities, require
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solvers.elimination import NodalSolution, StokesSystem, load_of, nodal_vector
from fsi.stokes.stress import bulk_stress, is_force_free, viscosity_checks


def evaluated(system: StokesSystem, nodal: NodalSolution, jump_load: Array, clock: Clock) -> StokesSolution:
    """Everything that follows from the nodal values; collective.

    Args:
        system: what was solved.
        nodal: the nodal values.
        jump_load: what jumps of the pressure added to the loads of the system.
        clock: of the solve.
    """
    problem, forms = system.problem, system.forms
    forms.fill(nodal.x)
    mean_pressure = _mean_pressure(system, nodal)
    if not problem.boundary.pressures:
        forms.p.x.array[:] -= mean_pressure
    F, dissipation = load_of(system, nodal.reaction), forms.integrate("dissipation")
    checks, bulk = identities(system, nodal, F, dissipation), None
    if problem.periodic:
        bulk = bulk_stress(system, nodal, mean_pressure)
        if is_force_free(system):
            checks |= viscosity_checks(problem, bulk, dissipation)
    require(checks)
    surface = traction.collect(system, nodal.reaction[: system.layout.velocities])
    field, traction_F = flow.capture(forms, system.nodes.with_ghosts), _by_traction(system, jump_load)
    clock.lap("checks")
    return StokesSolution(
        problem, nodal.U, F, traction_F, dissipation, checks, forms.dofs, nodal.iterations, clock.seconds,
        field, surface, bulk, nodal.pressure_gradient,
    )  # fmt: skip


def _mean_pressure(system: StokesSystem, nodal: NodalSolution) -> float:
    """Of the fluid, by its nodal values: their weights are the integrals of the shape functions."""
    here = np.array([system.weights @ nodal.x[system.layout.velocities :], system.weights.sum()])
    integral, area = system.layout.comm.allreduce(here)
    return float(integral / area)


def _by_traction(system: StokesSystem, jump_load: Array) -> Array:
    """Loads of the bodies, (N, M), as integrals of sigma_h n, on all arcs in the pressure of one image."""
    on_bodies = facets_with(system.problem.fluid, 1, system.problem.fluid.bodies)
    integral = -jump_load
    integral[: system.layout.velocities] += nodal_vector(system.forms.bind("traction", on_bodies))
    return load_of(system, integral)
