"""Solve Stokes flow around rigid bodies on one mesh, at one instant."""

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from math import inf

import numpy as np
from dolfinx import fem
from mpi4py import MPI

import fsi.parallel as parallel
from fsi.arrays import Array
from fsi.errors import RefusedError
from fsi.meshes.build import FluidMesh
from fsi.observables.solved_flow import BOUND
from fsi.stokes import fields
from fsi.stokes.closed import closed
from fsi.stokes.corners import jumps
from fsi.stokes.discretisation.constraints import DofLayout, dof_layout, rigid_modes, wall_offset
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.discretisation.images import tied
from fsi.stokes.discretisation.nodes import BoundaryNodes, facets_with, inner_nodes, locate
from fsi.stokes.discretisation.slip import sliding_facets, with_slip
from fsi.stokes.identities import identities, require
from fsi.stokes.laws import with_laws
from fsi.stokes.pressure_level import at_level, pressure_level
from fsi.stokes.problem import Formulation, SolverOptions, StokesProblem
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solvers import elimination
from fsi.stokes.solvers.gmres import SHARPER, TOLERANCE
from fsi.stokes.solvers.multiplier import solve_multiplier
from fsi.stokes.solvers.mumps import REFINE_ABOVE, REFINE_AT_FIRST_ABOVE
from fsi.stokes.solvers.periodic import solve_periodic
from fsi.stokes.solvers.schur import pressure_mass
from fsi.stokes.solvers.system import (
    NodalSolution,
    Solver,
    StokesSystem,
    friction_power,
    law_dissipation,
    law_loads,
    load_of,
    nodal_vector,
)
from fsi.stokes.solvers.workspace import Workspace
from fsi.stokes.stress import bulk_stress, is_force_free, viscosity_checks
from fsi.stokes.swimming import swimming_velocity


class Clock:
    """CPU seconds of this process by phase."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.process_time()

    def lap(self, phase: str) -> None:
        """Add the time since the last lap to a phase."""
        now = time.process_time()
        self.seconds[phase] = self.seconds.get(phase, 0.0) + now - self._last
        self._last = now


# Beyond, in space, the factors of the direct solver cost more time and memory than the iterations.
MOST_DIRECT = 20_000
DEFAULT = SolverOptions()
# A tenth of what identities may violate: where one misses more, residuals that were left are refined.
SUFFICIENT = 0.1 * BOUND
# Of a law's resistance, in the units of the model: with TOLERANCE powers miss their bound from 5e3 on.
STEEP = 1e3

FORMULATIONS: dict[Formulation, Solver] = {
    "eliminated": elimination.solve_eliminated,
    "multiplier": solve_multiplier,
}


def solve(
    problem: StokesProblem,
    options: SolverOptions = DEFAULT,
    clock: Clock | None = None,
    workspace: Workspace | None = None,
) -> StokesSolution:
    """Velocity, pressure, reactions and the motion of the bodies; collective.

    clock: takes the CPU seconds by phase; may have some already. workspace: what solves on this mesh share
    while it is moved; it keeps what this one makes. Raises SolveError: singular system, large residual, or an
    identity violated.
    """
    clock = clock or Clock()
    with assembled(problem, options, clock, workspace) as system:
        try:
            found = _solved(replace(system, refine_above=REFINE_AT_FIRST_ABOVE), options, clock)
            if system.mass is not None or _suffices(found.checks):
                return found
        except RefusedError:
            if system.mass is not None and system.tolerance == SHARPER:
                raise
        # A residual is relative to loads: where walls carry everything along alike, 1e-14 of them in a gap of
        # 0.01 radii is a force of 1e-10 on a body that has none. Refined it is 1e-14.
        return _solved(replace(system, tolerance=SHARPER, refine_above=0.0), options, clock)


def _suffices(checks: Mapping[str, float]) -> bool:
    """Whether identities hold so well that no residual need be refined, or none is left that would be."""
    return checks["residual"] <= REFINE_ABOVE or max(checks.values()) <= SUFFICIENT


def _solved(system: StokesSystem, options: SolverOptions, clock: Clock) -> StokesSolution:
    """The solution of an assembled system; collective."""
    solve_system, jump_load = with_laws(FORMULATIONS[options.formulation]), np.zeros(system.layout.velocities)
    if system.problem.periodic:
        system, nodal, jump_load = solve_periodic(system, solve_system)
    else:
        (nodal,) = solve_system(system)
    clock.lap("solve")
    return _evaluated(system, nodal, jump_load, clock)


@contextmanager
def assembled(
    problem: StokesProblem, options: SolverOptions, clock: Clock, workspace: Workspace | None = None
) -> Iterator[StokesSystem]:
    """The assembled system of `solve`, with the same arguments; collective."""
    fluid = problem.fluid
    with nullcontext(workspace) if workspace else Workspace() as workspace:
        forms = workspace.forms(fluid, options.degree, problem.viscosity)
        nodes = locate(fluid, forms.V)
        iterative = is_iterative(options, forms) and not problem.sliding
        weights = nodal_vector(forms.bind("pressure weights"))
        closed = not problem.boundary.pressures
        pin = _pinned_pressure(fluid, forms, weights) if closed and not iterative else None
        cells = workspace.cells(condensed=options.formulation == "eliminated" and not iterative)
        layout = replace(_layout(problem, forms, nodes, pin), inner=cells.inner_here)
        g = _offset(problem, forms, nodes, layout)
        b = _loads(problem, forms, layout.rows)
        clock.lap("setup")
        mass = pressure_mass(forms) if iterative else None
        rigid = rigid_modes(layout, nodes, problem.q, fluid.lattice)
        facets = sliding_facets(problem, forms, cells.shared, nodes, g) if problem.sliding else None
        system = StokesSystem(
            problem=problem, forms=forms, nodes=nodes, layout=layout, cells=cells, rigid=rigid, b=b, g=g,
            weights=weights, mass=mass, workspace=workspace, facets=facets, tolerance=_tolerance(problem),
        )  # fmt: skip
        clock.lap("assemble")
        try:
            with parallel.together():
                yield system
        finally:
            for used in (rigid.matrix, mass):
                if used is not None:
                    used.destroy()


def _layout(problem: StokesProblem, forms: Forms, nodes: BoundaryNodes, pin: int | None) -> DofLayout:
    """Which unknowns walls and bodies fix, slip and periods tie; collective."""
    pressure_nodes = forms.Q.dofmap.index_map.size_local
    layout = dof_layout(problem.fluid, nodes, problem.boundary.velocities, pressure_nodes, pin)
    spaces = [(forms.V, nodes.with_ghosts), (forms.Q, forms.Q.tabulate_dof_coordinates())]
    return tied(with_slip(layout, problem, nodes), problem.fluid, spaces)


def _offset(problem: StokesProblem, forms: Forms, nodes: BoundaryNodes, layout: DofLayout) -> Array:
    """g, the velocities that are given: of walls, of surfaces that swim, and with which laws carry bodies."""
    boundary, container = problem.boundary, problem.container
    at_walls = {wall: u(nodes.x[nodes.wall_nodes[wall]]) for wall, u in boundary.velocities.items()}
    # Where fluid sticks to one of two walls that meet, that one has the last word.
    at_walls = dict(sorted(at_walls.items(), key=lambda item: item[0] not in boundary.slip_lengths))
    corner_axes = dict(zip(container.walls, container.corner_axes, strict=True))
    g = closed(problem, forms, nodes, layout, wall_offset(layout, nodes, at_walls, corner_axes))
    g += swimming_velocity(problem, forms, nodes, layout)
    if problem.laws is not None:
        carried, d = problem.laws.carried, problem.q.dimension
        g[layout.on_body] += carried[layout.body, layout.on_body % d]
    return g


def _tolerance(problem: StokesProblem) -> float:
    """Of residuals of the iterative solver, which are relative to loads: those of stiff laws are large."""
    stiffest = 0.0 if problem.laws is None else np.abs(problem.laws.resistance).max(initial=0.0)
    return SHARPER if stiffest > STEEP else TOLERANCE


def is_iterative(options: SolverOptions, forms: Forms) -> bool:
    """Whether a system is solved iteratively: as the user says, else large ones in space."""
    if options.formulation == "multiplier":
        return False
    if options.solver == "automatic":
        return forms.mesh.topology.dim == 3 and forms.dofs > MOST_DIRECT
    return options.solver == "iterative"


def _pinned_pressure(fluid: FluidMesh, forms: Forms, weights: Array) -> int | None:
    """Local number of the pressure node to pin, on its owner: the first whose weight |int q| is largest.

    A node inside a gap would lose 7 digits: its divergence row is the smallest of all. One on the cut of a
    periodic domain would have an image that is not pinned. One within a cell is no unknown of the sum.
    Weights count to a factor of two: of equal ones another would be largest each time a mesh has moved, and
    what solves on it share would be made anew.
    """
    weights = np.ldexp(np.abs(np.sign(weights)), np.frexp(weights)[1])
    cells = forms.Q.dofmap.list[: fluid.mesh.topology.index_map(fluid.dimension).size_local]
    weights[cells[:, inner_nodes(forms.Q)]] = 0.0
    if fluid.lattice.dimension:
        facets = fluid.facet_tags.find(fluid.cut_tag)
        on_cut = fem.locate_dofs_topological(forms.Q, fluid.dimension - 1, facets)
        weights[on_cut[on_cut < len(weights)]] = 0.0
    largest_here = (float(weights.max(initial=-1.0)), -MPI.COMM_WORLD.rank)
    if MPI.COMM_WORLD.allreduce(largest_here, op=MPI.MAX) != largest_here:
        return None
    return int(np.argmax(weights))


def _loads(problem: StokesProblem, forms: Forms, rows: int) -> Array:
    """Nodal loads b: (f, v) and, on open walls, <t, v> with t = -p n; this rank's rows.

    Without the level of the pressures outside, beside which residuals would say nothing of the flow.
    """
    fluid, boundary, b = problem.fluid, problem.boundary, np.zeros(rows)
    velocities = forms.velocities
    if (f := boundary.body_force) is not None:
        forms.f.interpolate(lambda x: f(x[: fluid.dimension].T).T)
        b[:velocities] += nodal_vector(forms.bind("load"))
    for wall, pressure in boundary.pressures.items():
        tag = fluid.wall_tag(wall)
        normal = nodal_vector(forms.bind("normal", facets_with(fluid, tag, tag)))
        b[:velocities] -= (pressure - boundary.outside_level) * normal
    return b


def _evaluated(system: StokesSystem, nodal: NodalSolution, jump_load: Array, clock: Clock) -> StokesSolution:
    """Everything that follows from nodal values: loads, checks, mean stress, and the flow for output.

    jump_load: what jumps of the pressure between arcs of a body add to its loads, this rank's rows of u.
    """
    problem, forms = system.problem, system.forms
    forms.fill(nodal.x)
    level = pressure_level(system, nodal)
    dissipation, more = system.cells.dissipation(), law_loads(system, nodal)
    of_laws = law_dissipation(system, nodal)
    checks, bulk = identities(system, nodal, nodal.load, dissipation), None
    if problem.periodic:
        bulk = bulk_stress(system, nodal, at_level(system, nodal.reaction, level.of_stresslets))
        if is_force_free(system):
            elsewhere = friction_power(system, nodal) + of_laws
            checks |= viscosity_checks(problem, bulk, dissipation + elsewhere)
    require(checks)
    forms.p.x.array[:] -= level.of_fluid
    walls = problem.container.walls
    jumping = tuple((walls[k], walls[m]) for k, m in jumps(problem.container, problem.boundary))
    surface = fields.surfaces(system, at_level(system, nodal.reaction, level.of_tractions))
    flow = fields.capture(forms, system.nodes.with_ghosts)
    # Integrals of sigma_h n, on all arcs in the pressure of one image.
    integral = np.zeros(system.layout.rows)
    on_bodies = facets_with(problem.fluid, 1, problem.fluid.bodies)
    integral[: system.layout.velocities] = nodal_vector(forms.bind("traction", on_bodies)) - jump_load
    traction_F = load_of(system, integral) + more
    clock.lap("checks")
    return StokesSolution(
        U=nodal.U, F=nodal.load + more, traction_F=traction_F,
        dissipation=inf if jumping else dissipation + of_laws, checks=checks,
        dofs=forms.dofs, cells=problem.fluid.cells(), iterations=nodal.iterations, seconds=clock.seconds,
        bulk=bulk, jumps=jumping, problem=problem, flow=flow, surface=surface,
        mean_pressure_gradient=nodal.pressure_gradient,
        flux=nodal.flux, wall_speeds=nodal.wall_speeds, shear_rate=nodal.shear_rate,
        law_dissipation=None if problem.laws is None else of_laws,
        slip_dissipation=friction_power(system, nodal) if problem.sliding else None,
    )  # fmt: skip
