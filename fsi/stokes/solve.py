"""Solve Stokes flow around rigid bodies on one mesh, at one instant."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fsi.bodies import Array, Configuration, Inertia, Motion
from fsi.stokes import fields, surface
from fsi.stokes.boundary import BoundaryNodes, facets_with, locate
from fsi.stokes.constraints import layout, rigid_modes, wall_offset
from fsi.stokes.forms import Forms
from fsi.stokes.identities import identities, require
from fsi.stokes.saddle import solve_multiplier
from fsi.stokes.solution import StokesSolution
from fsi.stokes.system import (
    NodalSolution,
    System,
    load_of,
    nodal_vector,
    pressure_mass,
    solve_eliminated,
    stokes_matrix,
)
from meshes.build import FluidMesh
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
    """

    velocities: Mapping[str, Field]
    pressures: Mapping[str, float]
    body_force: Field | None = None


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

    Raises:
        SolveError: singular system, large residual, or an identity violated.
    """
    clock = clock or Clock()
    if formulation == "multiplier":
        solver = "direct"
    given = assembled(fluid, container, q, motion, boundary, viscosity, degree, inertia, clock, solver)
    with given as (system, forms, nodes):
        nodal = FORMULATIONS[formulation](system)
        clock.lap("solve")
        return _finish(
            system, fluid, forms, nodes, nodal, q, viscosity, closed=not boundary.pressures, clock=clock
        )


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
) -> Iterator[tuple[System, Forms, BoundaryNodes]]:
    """The assembled system of `solve`, with the same arguments; collective."""
    forms = Forms(fluid, degree, viscosity)
    nodes = locate(fluid, forms.V)
    closed = not boundary.pressures
    iterative = is_iterative(solver, forms)
    pin = _pinned_pressure(forms) if closed and not iterative else None
    pressure_nodes = forms.Q.dofmap.index_map.size_local
    shares = layout(fluid.mesh.comm, nodes, tuple(boundary.velocities), pressure_nodes, pin, fluid)
    at_walls = {wall: u(nodes.x[nodes.wall_nodes[wall]]) for wall, u in boundary.velocities.items()}
    g = wall_offset(shares, nodes, at_walls, dict(zip(container.walls, container.corner_axes, strict=True)))
    b = _loads(fluid, forms, boundary, shares.rows)
    clock.lap("setup")
    mass = pressure_mass(forms) if iterative else None
    system = System(
        shares, stokes_matrix(forms), rigid_modes(shares, nodes, q), b, g, q, motion, inertia, nodes.x, mass,
        closed,
    )  # fmt: skip
    clock.lap("assemble")
    try:
        yield system, forms, nodes
    finally:
        system.M.destroy()
        system.rigid.destroy()
        if system.mass is not None:
            system.mass.destroy()


def is_iterative(solver: str, forms: Forms) -> bool:
    """Whether a system is solved iteratively: as the user says, else large ones in space."""
    if solver == "automatic":
        return forms.mesh.topology.dim == 3 and forms.dofs > MOST_DIRECT
    return solver == "iterative"


def _pinned_pressure(forms: Forms) -> int | None:
    """Local number of the pressure node to pin, on its owner: the one with the largest weight |int q|.

    A node inside a gap would lose 7 digits: its divergence row is the smallest of all.
    """
    weights = np.abs(nodal_vector(forms.bind("pressure weights")))
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


def _finish(
    system: System, fluid: FluidMesh, forms: Forms, nodes: BoundaryNodes, nodal: NodalSolution,
    q: Configuration, viscosity: float, *, closed: bool, clock: Clock,
) -> StokesSolution:  # fmt: skip
    """Everything that follows from the nodal values."""
    velocities = system.shares.velocities
    fill(forms, nodal.x)
    if closed:
        forms.p.x.array[:] -= forms.integrate("pressure integral") / forms.integrate("area")
    F = load_of(system, nodal.reaction)
    on_bodies = facets_with(fluid, 1, fluid.bodies)
    integral = np.zeros(system.shares.rows)
    integral[:velocities] = nodal_vector(forms.bind("traction", on_bodies))
    dissipation = forms.integrate("dissipation")
    checks = identities(system, forms, nodal, F, dissipation, viscosity, q, nodes.x)
    require(checks)
    own_surface = surface.collect(fluid, forms.V, nodal.reaction[:velocities])
    flow = fields.capture(forms)
    clock.lap("checks")
    return StokesSolution(
        nodal.U, F, load_of(system, integral), dissipation, checks, forms.dofs, fluid.cells(),
        nodal.iterations, fluid.quality, clock.seconds, flow, own_surface,
    )  # fmt: skip
