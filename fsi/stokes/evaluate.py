"""From nodal values to a solution: loads, checks, mean stress, and what output needs of the flow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fsi.bodies.configuration import Array, Configuration
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.containers import Container
from fsi.meshes.geometry.periodic import Cell, Channel
from fsi.stokes.clock import Clock
from fsi.stokes.discretisation.boundary import Boundary, BoundaryNodes, facets_with
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.fields import traction as surface
from fsi.stokes.fields import write as fields
from fsi.stokes.identities import identities, require
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solvers.elimination import NodalSolution, System, load_of, nodal_vector
from fsi.stokes.stress import bulk_stress, is_force_free, strain_rate, viscosity_checks


def fill(forms: Forms, x: Array) -> None:
    """Set u and p of the forms to nodal values, this rank's rows."""
    velocities = forms.velocities
    for function, values in ((forms.u, x[:velocities]), (forms.p, x[velocities:])):
        function.x.array[: len(values)] = values
        function.x.scatter_forward()


@dataclass(frozen=True, slots=True)
class Found:
    """A solved system, and what it was made of.

    jump_load: what jumps of the pressure added to its loads; interaction: sum of r (x) F of the forces
    between bodies, (d, d).
    """

    system: System
    fluid: FluidMesh
    forms: Forms
    nodes: BoundaryNodes
    nodal: NodalSolution
    q: Configuration
    viscosity: float
    jump_load: Array
    interaction: Array


def evaluated(found: Found, container: Container, boundary: Boundary, clock: Clock) -> StokesSolution:
    """Everything that follows from the nodal values."""
    system, fluid, forms, nodal = found.system, found.fluid, found.forms, found.nodal
    fill(forms, nodal.x)
    mean_pressure = _mean_pressure(system, nodal)
    if not boundary.pressures:
        forms.p.x.array[:] -= mean_pressure
    F, dissipation = load_of(system, nodal.reaction), forms.integrate("dissipation")
    checks = identities(
        system, forms, nodal, F, dissipation, found.viscosity, found.q, found.nodes.x,
        fluid.lattice.dimension > 0,
    )  # fmt: skip
    bulk = None
    if isinstance(container, Channel | Cell):
        E = strain_rate(container, boundary.velocities)
        bulk = bulk_stress(
            system, found.nodes, nodal, container, found.q, E, mean_pressure, found.viscosity,
            found.interaction,
        )  # fmt: skip
        if is_force_free(system) and not found.interaction.any():
            checks |= viscosity_checks(bulk, E, dissipation, found.viscosity, found.q)
    require(checks)
    x, of_velocity = found.nodes.with_ghosts, nodal.reaction[: system.shares.velocities]
    own_surface, flow = surface.collect(fluid, forms.V, x, of_velocity), fields.capture(forms, x)
    traction_F = _by_traction(found)
    clock.lap("checks")
    return StokesSolution(
        nodal.U, F, traction_F, dissipation, checks, forms.dofs, fluid.cells(), nodal.iterations,
        fluid.quality, clock.seconds, flow, own_surface, bulk,
    )  # fmt: skip


def _mean_pressure(system: System, nodal: NodalSolution) -> float:
    """Of the fluid, by its nodal values: their weights are the integrals of the shape functions."""
    own = np.array([system.weights @ nodal.x[system.shares.velocities :], system.weights.sum()])
    integral, area = system.shares.comm.allreduce(own)
    return float(integral / area)


def _by_traction(found: Found) -> Array:
    """Loads of the bodies, (N, M), as integrals of sigma_h n, on all arcs in the pressure of one image."""
    on_bodies = facets_with(found.fluid, 1, found.fluid.bodies)
    integral = -found.jump_load
    integral[: found.system.shares.velocities] += nodal_vector(found.forms.bind("traction", on_bodies))
    return load_of(found.system, integral)
