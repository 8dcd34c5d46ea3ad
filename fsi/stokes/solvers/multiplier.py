"""The saddle-point system with the traction multiplier: the definition of the resolved model.

Stationarity of the Lagrangian gives, for velocities, pressures, nodal tractions and rigid modes,

    [ A   B^T  -C^T   0  ] [ u ]   [ b ]     momentum
    [ B   0     0     0  ] [ p ] = [ 0 ]     incompressibility
    [-C   0     0     K  ] [ l ]   [ 0 ]     u = V + omega x r on the bodies
    [ 0   0     K^T   D  ] [ U ]   [ F ]     balance of force and torque

where C picks the velocity nodes on bodies, K (`rigid` in `constraints`) holds the rigid modes there, and D is
the inertia of an implicit step (zero without inertia). Wall velocities are eliminated by a prolongation; held
modes move to the right-hand side. The multiplier IS the nodal traction.
"""

import numpy as np
from petsc4py import PETSc

from fsi.bodies.configuration import Array
from fsi.stokes.discretisation.constraints import Prolongation
from fsi.stokes.discretisation.shared_rows import Index
from fsi.stokes.solvers.assembly import CellSum
from fsi.stokes.solvers.extended import multiply, multiply_transpose
from fsi.stokes.solvers.mumps import Factorisation
from fsi.stokes.solvers.system import (
    NodalSolution,
    StokesSystem,
    body_velocity,
    law_equations,
    load_of,
    mode_equations,
)


def solve_multiplier(*systems: StokesSystem) -> list[NodalSolution]:
    """Solve saddle-point systems. Raises SolveError: one is singular, or its residual is not small."""
    return [_solve(system) for system in systems]


def _solve(system: StokesSystem) -> NodalSolution:
    layout, held = system.layout, system.problem.motion.held
    none = np.zeros_like(system.unknown_modes)
    prolongation = Prolongation(layout, system.rigid, none, eliminate_bodies=False)
    cells = CellSum(system.cells, prolongation)
    S, flow, M, b = prolongation.matrix, cells.matrix, cells.constrained, system.b
    # Rows of each rank: its unknowns (u, p), its multipliers, and on rank 0 the free modes.
    flow_rows, multiplier_rows = flow.getLocalSize()[0], len(layout.on_body)
    free = np.flatnonzero(~held.ravel())
    mode_rows = len(free) if layout.comm.rank == 0 else 0
    rows_here = flow_rows + multiplier_rows + mode_rows
    first = layout.comm.exscan(rows_here) or 0
    starts = layout.comm.allgather(first)
    root_mode = layout.comm.bcast(flow_rows + multiplier_rows)
    mode_column = np.full(layout.modes, -1)
    mode_column[free] = root_mode + np.arange(len(free))

    multiplier = first + flow_rows + np.arange(multiplier_rows)
    D, load = (values[free] for values in mode_equations(system))
    trace = _trace(S, layout.on_body, starts, multiplier)
    rigid = _rigid_columns(system, multiplier, mode_column)
    zero = (multiplier, multiplier, np.zeros(multiplier_rows))
    transposes = [(column, row, value) for row, column, value in (trace, rigid)]
    triplets = [_renumbered(flow, starts), trace, rigid, *transposes, zero]
    K, of_laws = law_equations(system)
    if mode_rows:
        triplets.append((mode_column[free], mode_column[free], D))
        if K is not None:
            entries = K[free][:, free].tocoo()
            triplets.append((mode_column[free[entries.row]], mode_column[free[entries.col]], entries.data))
    matrix = PETSc.Mat().createAIJ(size=((rows_here, None), (rows_here, None)), comm=layout.comm)
    rows, columns, values = (np.concatenate([t[k] for t in triplets]) for k in range(3))
    matrix.setPreallocationCOO(rows.astype(PETSc.IntType), columns.astype(PETSc.IntType))
    matrix.setValuesCOO(values)

    loads = multiply_transpose(S, b - M.transpose_times(system.g))
    no_slip = -body_velocity(system, system.problem.motion.U)[layout.on_body]
    rhs = np.concatenate([loads, no_slip, (load + of_laws[free])[:mode_rows]])
    with Factorisation(matrix, layout.dimension) as factors:
        solution, residual = (result[..., 0] for result in factors.solve(rhs[:, None]))
    x = multiply(S, solution[:flow_rows]) + system.g
    reaction = np.zeros(layout.rows)
    reaction[layout.on_body] = solution[flow_rows : flow_rows + multiplier_rows]
    # The multipliers do not hold M x - b on the rows of walls and of slaves.
    others = ~np.isin(M.rows, layout.on_body)
    reaction[M.rows[others]] = (M.times(x) - b[M.rows])[others]
    U = system.problem.motion.U.copy()
    U.ravel()[free] = layout.comm.bcast(solution[flow_rows + multiplier_rows :].copy())
    for used in (S, flow, matrix):
        used.destroy()
    return NodalSolution(x, reaction, load_of(system, reaction), U, float(residual))


def _renumbered(flow: PETSc.Mat, starts: list[int]) -> tuple[Index, Index, Array]:
    ranges = flow.getOwnershipRanges()
    start, end = flow.getOwnershipRange()
    indptr, column, value = flow.getValuesCSR()
    row = np.repeat(np.arange(start, end), np.diff(indptr))
    return _shifted(row, ranges, starts), _shifted(column, ranges, starts), value


def _shifted(number: Index, ranges: Index, starts: list[int]) -> Index:
    """From numbers shared out by `ranges` to numbers in which rank k's begin at starts[k]."""
    owner = np.searchsorted(ranges, number, side="right") - 1
    return np.asarray(number - np.asarray(ranges)[owner] + np.asarray(starts)[owner])


def _trace(S: PETSc.Mat, on_body: Index, starts: list[int], multiplier: Index) -> tuple[Index, Index, Array]:
    """Triplets of -C: the multiplier of a node on a body meets that node's own velocity."""
    indptr, column, _ = S.getValuesCSR()
    velocity = _shifted(column[indptr[on_body]], S.getOwnershipRangesColumn(), starts)
    return multiplier, velocity, -np.ones(len(multiplier))


def _rigid_columns(system: StokesSystem, multiplier: Index, mode_column: Index) -> tuple[Index, Index, Array]:
    row, mode, value = system.rigid.entries()
    of_row = np.full(system.layout.rows, -1)
    of_row[system.layout.on_body] = multiplier
    free = mode_column[mode] >= 0
    return of_row[row[free]], mode_column[mode[free]], value[free]
