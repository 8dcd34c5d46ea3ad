"""Solve Stokes flow around rigid bodies on one mesh, at one instant."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import partial

import numpy as np
from dolfinx import fem
from mpi4py import MPI

from fsi.bodies.configuration import Array, Configuration, Inertia, Motion
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.containers import Container
from fsi.meshes.geometry.periodic import Cell, Channel
from fsi.stokes.clock import Clock
from fsi.stokes.discretisation.boundary import Boundary, BoundaryNodes, facets_with, locate
from fsi.stokes.discretisation.constraints import layout, rigid_modes, wall_offset
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.discretisation.matrices import pressure_mass
from fsi.stokes.evaluate import Found, evaluated
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solvers.coarse import coarse_velocities
from fsi.stokes.solvers.elimination import NodalSolution, System, nodal_vector, solve_eliminated
from fsi.stokes.solvers.multiplier import solve_multiplier
from fsi.stokes.solvers.periodic import averages, jumps, mean_flow, solve_periodic, tied
from fsi.stokes.solvers.workspace import Workspace

# Beyond, in space, the factors of the direct solver cost more time and memory than the iterations.
MOST_DIRECT = 20_000

FORMULATIONS: dict[str, Callable[[System], NodalSolution]] = {
    "eliminated": solve_eliminated,
    "multiplier": solve_multiplier,
}


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
    interaction: Array | None = None,
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
        interaction: sum of r (x) F of the forces between bodies that `motion` has, (d, d), for the mean
            stress of a periodic flow; none: zero.
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
            average = partial(averages, forms, q, nodes.x, container.volume)
            system, nodal = solve_periodic(system, solve_system, jump, mean, average)
        else:
            nodal = solve_system(system)
        clock.lap("solve")
        carried = np.zeros((q.dimension, q.dimension)) if interaction is None else interaction
        found = Found(system, fluid, forms, nodes, nodal, q, viscosity, system.b - loads, carried)
        return evaluated(found, container, boundary, clock)


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
        weights = nodal_vector(forms.bind("pressure weights"))
        pin = _pinned_pressure(fluid, forms, weights) if closed and not iterative else None
        pressure_nodes = forms.Q.dofmap.index_map.size_local
        shares = layout(fluid.mesh.comm, nodes, tuple(boundary.velocities), pressure_nodes, pin, fluid)
        shares = tied(shares, fluid, forms, nodes.with_ghosts)
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
            inertia, nodes.x, weights, mass, coarse, closed, kept,
        )  # fmt: skip
        clock.lap("assemble")
        try:
            yield system, forms, nodes
        finally:
            system.rigid.matrix.destroy()
            if system.mass is not None:
                system.mass.destroy()
            if system.coarse is not None:
                system.coarse.nodal.destroy()


def is_iterative(solver: str, forms: Forms) -> bool:
    """Whether a system is solved iteratively: as the user says, else large ones in space."""
    if solver == "automatic":
        return forms.mesh.topology.dim == 3 and forms.dofs > MOST_DIRECT
    return solver == "iterative"


def _pinned_pressure(fluid: FluidMesh, forms: Forms, weights: Array) -> int | None:
    """Local number of the pressure node to pin, on its owner: the one with the largest weight |int q|, given.

    A node inside a gap would lose 7 digits: its divergence row is the smallest of all. One on the cut of a
    periodic domain would have an image that is not pinned.
    """
    weights = np.abs(weights)
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
