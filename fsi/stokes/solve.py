"""Solve Stokes flow around rigid bodies on one mesh, at one instant."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial

import meshes.backend  # noqa: F401

import numpy as np
from dolfinx import fem
from mpi4py import MPI

from fsi.bodies import Array, Configuration, Inertia, Motion
from fsi.stokes import fields, surface
from fsi.stokes.boundary import BoundaryNodes, facets_with, locate
from fsi.stokes.coarse import coarse_velocities
from fsi.stokes.constraints import layout, rigid_modes, wall_offset
from fsi.stokes.forms import Forms
from fsi.stokes.identities import identities, require
from fsi.stokes.matrices import pressure_mass
from fsi.stokes.periodic import averages, jumps, mean_flow, solve_periodic, tied
from fsi.stokes.saddle import solve_multiplier
from fsi.stokes.solution import StokesSolution
from fsi.stokes.stress import bulk_stress, is_force_free, strain_rate, viscosity_checks
from fsi.stokes.system import (
    NodalSolution,
    System,
    load_of,
    nodal_vector,
    solve_eliminated,
)
from fsi.stokes.workspace import Workspace
from meshes.build import FluidMesh
from meshes.cell import Cell, Channel
from meshes.geometry import Container

Field = Callable[[Array], Array]

# Beyond, in space, the factors of the direct solver cost more time and memory than the iterations.
MOST_DIRECT = 20_000

FORMULATIONS: dict[str, Callable[[System], NodalSolution]] = {
    "eliminated": solve_eliminated,
    "multiplier": solve_multiplier,
}


@dataclass(frozen=True, slots=True)
class Boundary:
    """What holds on the walls, and the body force.

    velocities: u(x) of the walls with a given velocity, (n, d) -> (n, d); pressures: p of the open walls,
    where the traction is sigma n = -p n; body_force: f(x), or None. Each wall is in exactly one of the two.
    Along a periodic channel: pressure_gradient: dp/dx, or None where the net_flux of fluid and bodies is
    given.
    """

    velocities: Mapping[str, Field]
    pressures: Mapping[str, float]
    body_force: Field | None = None
    pressure_gradient: float | None = 0.0
    net_flux: float = 0.0


class Clock:
    """CPU seconds of this process by phase."""

    def __init__(self) -> None:
        """Start."""
        self.seconds: dict[str, float] = {}
        self._last = time.process_time()

    def lap(self, phase: str) -> None:
        """Add the time since the last lap to a phase."""
        now = time.process_time()
        self.seconds[phase] = self.seconds.get(phase, 0.0) + now - self._last
        self._last = now


def solve(
    fluid: FluidMesh,
    container: Container,
    q: Configuration,
    motion: Motion,
    boundary: Boundary,
    *,
    viscosity: float = 1.0,
    degree: int = 3,
    formulation: str = "eliminated",
    solver: str = "automatic",
    inertia: Inertia | None = None,
    clock: Clock | None = None,
    workspace: Workspace | None = None,
) -> StokesSolution:
    """Velocity, pressure, reactions and the motion of the bodies; collective.

    Args:
        fluid: mesh of the fluid around the bodies at q.
        container: what encloses the fluid.
        q: the bodies.
        motion: held modes, their velocities, loads on the free modes.
        boundary: walls and body force.
        viscosity: mu.
        degree: of the velocity, at least the order of the mesh; the pressure has one less.
        formulation: "eliminated" (P^T M P) or "multiplier" (the saddle-point system); they agree to rounding.
        solver: of the eliminated form, "direct", "iterative" (in space), or "automatic" by size.
        inertia: of an implicit step; none: quasi-static.
        clock: takes the CPU seconds by phase; may have some already.
        workspace: what solves on this mesh share while it is moved; it keeps what this one makes.

    Raises:
        SolveError: singular system, large residual, or an identity violated.
    """
    clock = clock or Clock()
    if formulation == "multiplier":
        solver = "direct"
    given = assembled(
        fluid, container, q, motion, boundary, viscosity, degree, inertia, clock, solver, workspace
    )
    with given as (system, forms, nodes):
        solve_system, loads = FORMULATIONS[formulation], system.b
        if isinstance(container, Channel | Cell):
            mean = mean_flow(container, motion, boundary.pressure_gradient, boundary.net_flux)
            jump = jumps(system.shares, fluid, forms, q, nodes.x)
            average = partial(averages, forms, q, nodes.x, container.area)
            system, nodal = solve_periodic(system, solve_system, jump, mean, average)
        else:
            nodal = solve_system(system)
        clock.lap("solve")
        found = Found(system, fluid, forms, nodes, nodal, q, viscosity, system.b - loads)
        return _finish(found, container, boundary, clock)


@contextmanager
def assembled(
    fluid: FluidMesh,
    container: Container,
    q: Configuration,
    motion: Motion,
    boundary: Boundary,
    viscosity: float,
    degree: int,
    inertia: Inertia | None,
    clock: Clock,
    solver: str = "automatic",
    workspace: Workspace | None = None,
) -> Iterator[tuple[System, Forms, BoundaryNodes]]:
    """The assembled system of `solve`, with the same arguments; collective."""
    with nullcontext(workspace) if workspace else Workspace(lasting=False) as kept:
        forms = kept.forms(fluid, degree, viscosity)
        nodes = locate(fluid, forms.V)
        closed = not boundary.pressures
        iterative = is_iterative(solver, forms)
        pin = _pinned_pressure(fluid, forms) if closed and not iterative else None
        pressure_nodes = forms.Q.dofmap.index_map.size_local
        shares = layout(fluid.mesh.comm, nodes, tuple(boundary.velocities), pressure_nodes, pin, fluid)
        shares = tied(shares, fluid, forms)
        at_walls = {wall: u(nodes.x[nodes.wall_nodes[wall]]) for wall, u in boundary.velocities.items()}
        g = wall_offset(
            shares, nodes, at_walls, dict(zip(container.walls, container.corner_axes, strict=True))
        )
        b = _loads(fluid, forms, boundary, shares.rows)
        clock.lap("setup")
        mass = pressure_mass(forms) if iterative else None
        coarse = coarse_velocities(fluid, forms, tuple(boundary.velocities), q) if iterative else None
        system = System(
            shares, kept.stokes_matrix(), rigid_modes(shares, nodes, q, fluid.lattice), b, g, q, motion,
            inertia, nodes.x, mass, coarse, closed, kept,
        )  # fmt: skip
        clock.lap("assemble")
        try:
            yield system, forms, nodes
        finally:
            system.rigid.destroy()
            if system.mass is not None:
                system.mass.destroy()
            if system.coarse is not None:
                system.coarse.nodal.destroy()


def is_iterative(solver: str, forms: Forms) -> bool:
    """Whether a system is solved iteratively: as the user says, else large ones in space."""
    if solver == "automatic":
        return forms.mesh.topology.dim == 3 and forms.dofs > MOST_DIRECT
    return solver == "iterative"


def _pinned_pressure(fluid: FluidMesh, forms: Forms) -> int | None:
    """Local number of the pressure node to pin, on its owner: the one with the largest weight |int q|.

    A node inside a gap would lose 7 digits: its divergence row is the smallest of all. One on the cut of a
    periodic domain would have an image that is not pinned.
    """
    weights = np.abs(nodal_vector(forms.bind("pressure weights")))
    if fluid.lattice.dimension:
        on_cut = fem.locate_dofs_topological(forms.Q, 1, fluid.facet_tags.find(fluid.cut_tag))
        weights[on_cut[on_cut < len(weights)]] = 0.0
    own = (float(weights.max(initial=-1.0)), -forms.mesh.comm.rank)
    if forms.mesh.comm.allreduce(own, op=MPI.MAX) != own:
        return None
    return int(np.argmax(weights))


def _loads(fluid: FluidMesh, forms: Forms, boundary: Boundary, rows: int) -> Array:
    """Nodal loads b: (f, v) and, on open walls, <t, v> with t = -p n; this rank's rows."""
    b = np.zeros(rows)
    velocities = forms.velocities
    if boundary.body_force is not None:
        f = boundary.body_force
        forms.f.interpolate(lambda x: f(x[: fluid.dimension].T).T)
        b[:velocities] += nodal_vector(forms.bind("load"))
    for wall, pressure in boundary.pressures.items():
        tag = fluid.wall_tag(wall)
        b[:velocities] -= pressure * nodal_vector(forms.bind("normal", facets_with(fluid, tag, tag)))
    return b


def fill(forms: Forms, x: Array) -> None:
    """Set u and p of the forms to nodal values, this rank's rows."""
    velocities = forms.velocities
    for function, values in ((forms.u, x[:velocities]), (forms.p, x[velocities:])):
        function.x.array[: len(values)] = values
        function.x.scatter_forward()


@dataclass(frozen=True, slots=True)
class Found:
    """A solved system, and what it was made of; jump_load: what jumps of the pressure added to its loads."""

    system: System
    fluid: FluidMesh
    forms: Forms
    nodes: BoundaryNodes
    nodal: NodalSolution
    q: Configuration
    viscosity: float
    jump_load: Array


def _finish(found: Found, container: Container, boundary: Boundary, clock: Clock) -> StokesSolution:
    """Everything that follows from the nodal values."""
    system, fluid, forms, nodal = found.system, found.fluid, found.forms, found.nodal
    fill(forms, nodal.x)
    mean_pressure = forms.integrate("pressure integral") / forms.integrate("area")
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
        bulk = bulk_stress(system, found.nodes, nodal, container, found.q, E, mean_pressure, found.viscosity)
        if is_force_free(system):
            checks |= viscosity_checks(bulk, E, dissipation, found.viscosity, found.q)
    require(checks)
    own_surface = surface.collect(fluid, forms.V, nodal.reaction[: system.shares.velocities])
    flow = fields.capture(forms)
    traction_F = _by_traction(found)
    clock.lap("checks")
    return StokesSolution(
        nodal.U, F, traction_F, dissipation, checks, forms.dofs, fluid.cells(), nodal.iterations,
        fluid.quality, clock.seconds, flow, own_surface, bulk,
    )  # fmt: skip


def _by_traction(found: Found) -> Array:
    """Loads of the bodies, (N, M), as integrals of sigma_h n, on all arcs in the pressure of one image."""
    on_bodies = facets_with(found.fluid, 1, found.fluid.bodies)
    integral = -found.jump_load
    integral[: found.system.shares.velocities] += nodal_vector(found.forms.bind("traction", on_bodies))
    return load_of(found.system, integral)
