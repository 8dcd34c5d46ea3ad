"""The discrete Stokes system around rigid bodies solved by elimination.

Without constraints, for nodal values x = (u, p), the rows of u read

    M x = b + lambda      M = [A B^T; B 0],   b = loads (f, v) and <t, v> on open walls,

where lambda, the nodal reaction, is zero inside and unknown on bodies, walls and the sides of periodic
domains. With x = P y + g (see `constraints`), rigid^T lambda = (F, T) for every free mode closes the system:

    P^T M P y = P^T (b - M g) + (F, T)

and lambda comes back as M x - b. Both g and lambda live on constrained rows; of M itself only those rows are
needed. This is EXACTLY the saddle-point system of `multiplier`, with its multiplier and the rigid boundary
values eliminated.

The direct solver leaves held modes out of y; the iterative one, which wants whole bodies, keeps all modes in
y and sets the held ones to zero.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from petsc4py import PETSc

import fsi.parallel as parallel
from fsi.arrays import Array
from fsi.bodies.surface_gap import narrowest_gap
from fsi.errors import RefusedError, SolveError
from fsi.stokes.problem import StokesProblem
from fsi.stokes.solvers.components import COMPONENTS
from fsi.stokes.solvers.gmres import Iteration, SchurBlocks
from fsi.stokes.solvers.multigrid import levels
from fsi.stokes.solvers.mumps import Factorisation
from fsi.stokes.solvers.reduced import Added, Elimination
from fsi.stokes.solvers.schur import film_matrix
from fsi.stokes.solvers.system import (
    NodalSolution,
    StokesSystem,
    body_velocity,
    law_equations,
    load_of,
    mode_equations,
)

NARROW = 1e-5  # of a radius: such gaps are solved in extended precision
# Part of the load of a body by which its balance may miss. Mostly it misses 1e-12, then nothing is refined.
LOADS_TO = 1e-9

type Responses = Callable[[Sequence[StokesSystem]], Iterator[NodalSolution]]


def solve_eliminated(*systems: StokesSystem) -> list[NodalSolution]:
    """Solve for y, then x = P y + g and lambda = M x - b. Raises SolveError as `factorised`.

    All have one matrix: they differ in what is given and in their loads alone.
    """
    with factorised(systems[0]) as responses:
        return list(responses(systems))


@contextmanager
def factorised(system: StokesSystem) -> Iterator[Responses]:
    """Factorise P^T M P once: gives the solutions of all systems that have this matrix; collective.

    Or set up the iterative solver once. Raises SolveError: the system is singular, or the residual of a
    solution is not small.
    """
    unknown = system.unknown_modes
    added = Added(mode_equations(system)[0], system.facets, law_equations(system)[0])
    elimination = system.workspace.elimination(system.layout, system.rigid, unknown, added)
    narrow = _is_narrow(system.problem)
    precision = np.longdouble if narrow else np.float64
    if system.mass is None:
        factors = elimination.factors()
        factors.extended, factors.refine_above = narrow, system.refine_above
        yield lambda systems: _respond(systems, elimination, factors, precision)
        return
    try:
        with parallel.together(), _iteration(system, system.mass, elimination) as iteration:
            yield lambda systems: _respond(systems, elimination, iteration, precision)
    finally:
        system.workspace.forget_elimination()


def _is_narrow(problem: StokesProblem) -> bool:
    """Whether fluid may be shut in by gaps below NARROW."""
    narrowest = narrowest_gap(problem.q, problem.container)
    return narrowest is not None and narrowest.width < NARROW * problem.q.radii[narrowest.sides[0]]


def _solutions(problem: StokesProblem, solver: Factorisation | Iteration, rhs: Array) -> tuple[Array, Array]:
    """Those of the solver, with residuals. Raises SolveError: as the solver, or one that says why."""
    try:
        return solver.solve(rhs)
    except RefusedError as error:
        if not _only_friction_holds(problem):
            raise
        raise SolveError(
            f"{error}: nothing but the friction viscosity / slip_length of the walls holds fluid and bodies, "
            "and too little of it is left beside rounding; lower slip_length in domain.walls, or hold a body"
        ) from error


def _only_friction_holds(problem: StokesProblem) -> bool:
    """Whether everything may slide along a channel, or turn within a round container, but for friction."""
    container, slip_lengths = problem.container, problem.boundary.slip_lengths
    is_round = not all(container.plane) and not container.axisymmetric
    slides = bool(slip_lengths) and set(slip_lengths) == set(container.walls)
    return slides and (problem.periodic or is_round) and not problem.motion.held.any()


def _iteration(system: StokesSystem, mass: PETSc.Mat, elimination: Elimination) -> Iteration:
    """The iterative solver; it changes the matrix."""
    elimination.forget_sum()
    reduced, first_mode = elimination.reduced, elimination.first_mode
    layout, start = system.layout, reduced.getOwnershipRange()[0]
    held = np.flatnonzero(system.problem.motion.held.ravel())[: system.modes_here]
    reduced.zeroRowsColumns((start + first_mode + held).astype(PETSc.IntType), diag=1.0)
    pressures = int(layout.free[layout.velocities :].sum())
    of_nodes = np.tile(np.eye(COMPONENTS), ((first_mode - pressures) // COMPONENTS, 1))
    of_bodies = np.eye(layout.modes_of_each, COMPONENTS) * ~system.problem.motion.held[..., None]
    modes = np.arange(first_mode, first_mode + system.modes_here)
    of_pressures = np.arange(first_mode - pressures, first_mode)
    D = np.concatenate([np.zeros(len(of_nodes)), mode_equations(system)[0][: system.modes_here]])
    films = film_matrix(system.problem, system.forms, mass)
    with levels(system.problem, system.forms) as hierarchy:
        blocks = SchurBlocks(
            u=start + np.concatenate([np.arange(first_mode - pressures), modes]),
            p=start + of_pressures,
            levels=hierarchy,
            mass=elimination.tied(mass, of_pressures),
            films=elimination.tied(films, of_pressures),
            closed=not system.problem.boundary.pressures,
            translations=np.concatenate([of_nodes, of_bodies.reshape(-1, COMPONENTS)[: system.modes_here]]),
            D=D,
        )
        return Iteration(reduced, blocks, system.tolerance)


def _respond(
    systems: Sequence[StokesSystem],
    elimination: Elimination,
    solver: Factorisation | Iteration,
    precision: type[np.floating[Any]],
) -> Iterator[NodalSolution]:
    """The solutions of systems that have the same matrix; precision: of the loads."""
    system = systems[0]
    free, unknown, modes_here = ~system.problem.motion.held, system.unknown_modes, system.modes_here
    M, first_mode = elimination.constrained, elimination.first_mode
    g = [each.g + body_velocity(each, each.problem.motion.U) for each in systems]
    # M is symmetric.
    offsets = zip(systems, g, strict=True)
    loads = np.column_stack([each.b - M.transpose_times(g.astype(precision)) for each, g in offsets])
    if system.facets is not None:  # the friction where g is not the velocity of a wall, at its corners
        loads -= system.facets.forces(np.zeros(system.layout.rows))[0][:, None]
    rhs = elimination.restricted(loads)
    of_modes = rhs[first_mode : first_mode + modes_here]
    given = [mode_equations(each)[1] + law_equations(each)[1] for each in systems]
    of_modes += np.column_stack([load[unknown][:modes_here] for load in given])
    # Held modes that stand in y all the same are zero there: g has what they do.
    of_modes[~free.ravel()[unknown][:modes_here]] = 0.0
    elimination.allowed = np.column_stack([_allowed(each)[unknown][:modes_here] for each in systems])
    solutions, residuals = _solutions(system.problem, solver, rhs)
    for each, offset, y, residual in zip(systems, g, solutions.T, residuals, strict=True):
        x = elimination.prolonged(y[:, None])[:, 0] + offset
        moved = each.problem.motion.U.copy()
        of_modes = y[first_mode : first_mode + modes_here]
        moved[free] = system.layout.comm.bcast(of_modes)[free.ravel()[unknown]]
        reaction = np.zeros_like(x)
        reaction[M.rows] = M.times(x) - each.b[M.rows]
        load = load_of(system, reaction)
        x, reaction = x.astype(float, copy=False), reaction.astype(float, copy=False)
        yield NodalSolution(x, reaction, load, moved, float(residual), solver.iterations)


def _allowed(system: StokesSystem) -> Array:
    """Defects of balances that are small beside the load that a body is given, (M N,); any where it is 0."""
    arms = system.problem.q.arms
    own = (np.abs(mode_equations(system)[1].reshape(arms.shape)) / arms).max(axis=1, keepdims=True)
    return np.asarray(np.where(own > 0.0, LOADS_TO * own * arms, np.inf).ravel())
