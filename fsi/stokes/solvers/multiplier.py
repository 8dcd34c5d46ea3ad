"""The saddle-point system with the traction multiplier: the definition of the resolved model.

Stationarity of the Lagrangian gives, for velocities, pressures, nodal tractions and rigid modes,

    [ A   B^T  -C^T   0  ] [ u ]   [ b ]     momentum
    [ B   0     0     0  ] [ p ] = [ 0 ]     incompressibility
    [-C   0     0     K  ] [ l ]   [ 0 ]     u = V + omega x r on the bodies
    [ 0   0     K^T   D  ] [ U ]   [ F ]     balance of force and torque

where C picks the velocity nodes on bodies, K (`rigid` in `constraints`) holds the rigid modes there, and
D is the inertia of an implicit step (zero without inertia). Wall velocities are eliminated by a
prolongation; held modes move to the right-hand side. The multiplier IS the nodal traction.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.bodies.configuration import Array
from fsi.stokes.discretisation.constraints import Prolongation
from fsi.stokes.discretisation.matrices import galerkin
from fsi.stokes.solvers.elimination import (
    NodalSolution,
    System,
    body_velocity,
    mode_equations,
    multiply,
    multiply_transpose,
)
from fsi.stokes.solvers.mumps import Factorisation

Index = NDArray[np.int64]


def solve_multiplier(system: System) -> NodalSolution:
    """Solve the saddle-point system as it stands above.

    Raises:
        SolveError: the system is singular, or its residual is not small.
    """
    shares, held = system.shares, system.motion.held
    S = Prolongation(shares, system.rigid, np.zeros_like(system.kept), eliminate_bodies=False).matrix
    flow = galerkin(system.M, S)
    # Rows of each rank: its unknowns (u, p), its multipliers, and on rank 0 the free modes.
    own_flow, own_multipliers = flow.getLocalSize()[0], len(shares.on_body)
    free = np.flatnonzero(~held.ravel())
    own_modes = len(free) if shares.comm.rank == 0 else 0
    own = own_flow + own_multipliers + own_modes
    first = shares.comm.exscan(own) or 0
    starts = shares.comm.allgather(first)
    root_mode = shares.comm.bcast(own_flow + own_multipliers)
    mode_column = np.full(shares.modes, -1)
    mode_column[free] = root_mode + np.arange(len(free))

    multiplier = first + own_flow + np.arange(own_multipliers)
    D, load = (values[free] for values in mode_equations(system))
    triplets = [
        _renumbered(flow, starts),
        *_symmetric(*_trace(S, shares.on_body, starts, multiplier)),
        *_symmetric(*_rigid_columns(system, multiplier, mode_column)),
        (multiplier, multiplier, np.zeros(own_multipliers)),
    ]
    if own_modes:
        triplets.append((mode_column[free], mode_column[free], D))
    matrix = PETSc.Mat().createAIJ(size=((own, None), (own, None)), comm=shares.comm)
    rows, columns, values = (np.concatenate([t[k] for t in triplets]) for k in range(3))
    matrix.setPreallocationCOO(rows.astype(PETSc.IntType), columns.astype(PETSc.IntType))
    matrix.setValuesCOO(values)

    loads = multiply_transpose(S, system.b - multiply(system.M, system.g))
    no_slip = -body_velocity(system, system.motion.U)[shares.on_body]
    rhs = np.concatenate([loads, no_slip, load[:own_modes]])
    with Factorisation(matrix) as factors:
        solution, residual = (found[..., 0] for found in factors.solve(rhs[:, None]))
    x = multiply(S, solution[:own_flow]) + system.g
    reaction = np.zeros(shares.rows)
    reaction[shares.on_body] = solution[own_flow : own_flow + own_multipliers]
    reaction = _with_walls(system, x, reaction)
    U = system.motion.U.copy()
    U.ravel()[free] = shares.comm.bcast(solution[own_flow + own_multipliers :].copy())
    for used in (S, flow, matrix):
        used.destroy()
    return NodalSolution(x, reaction, U, float(residual))


def _with_walls(system: System, x: Array, reaction: Array) -> Array:
    """Add what the multipliers do not hold: M x - b on the rows of walls and of slaves."""
    complete = reaction.copy()
    fixed = np.concatenate([system.shares.fixed, system.shares.slave])
    complete[fixed] = (multiply(system.M, x) - system.b)[fixed]
    return complete


def _renumbered(flow: PETSc.Mat, starts: list[int]) -> tuple[Index, Index, Array]:
    """Triplets of the flow block in the numbers of the whole system."""
    ranges = flow.getOwnershipRanges()
    start, end = flow.getOwnershipRange()
    indptr, column, value = flow.getValuesCSR()
    row = np.repeat(np.arange(start, end), np.diff(indptr))
    return _shifted(row, ranges, starts), _shifted(column, ranges, starts), value


def _shifted(number: Index, ranges: Index, starts: list[int]) -> Index:
    """From numbers shared out by `ranges` to numbers in which rank k's begin at starts[k]."""
    owner = np.searchsorted(ranges, number, side="right") - 1
    shifted: Index = number - np.asarray(ranges)[owner] + np.asarray(starts)[owner]
    return shifted


def _trace(S: PETSc.Mat, on_body: Index, starts: list[int], multiplier: Index) -> tuple[Index, Index, Array]:
    """Triplets of -C: the multiplier of a node on a body meets that node's own velocity."""
    indptr, column, _ = S.getValuesCSR()
    velocity = _shifted(column[indptr[on_body]], S.getOwnershipRangesColumn(), starts)
    return multiplier, velocity, -np.ones(len(multiplier))


def _rigid_columns(system: System, multiplier: Index, mode_column: Index) -> tuple[Index, Index, Array]:
    """Triplets of K: multipliers against free modes."""
    row, mode, value = system.rigid.entries()
    of_row = np.full(system.shares.rows, -1)
    of_row[system.shares.on_body] = multiplier
    free = mode_column[mode] >= 0
    return of_row[row[free]], mode_column[mode[free]], value[free]


def _symmetric(row: Index, column: Index, value: Array) -> list[tuple[Index, Index, Array]]:
    """A block and its transpose."""
    return [(row, column, value), (column, row, value)]
