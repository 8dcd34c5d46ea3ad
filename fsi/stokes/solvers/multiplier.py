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

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from fsi.arrays import Array, Indices
from fsi.stokes.discretisation.constraints import Prolongation
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


@dataclass(frozen=True, slots=True)
class _Numbers:
    """Numbers of the rows of all ranks: of each its unknowns (u, p), its multipliers, and of root the modes.

    Attributes:
        starts: where the rows of each rank begin.
        flow: how many unknowns (u, p) this rank has.
        multiplier: numbers of its multipliers.
        mode: numbers of all modes, -1 of those that are held.
        free: which modes are free.
        free_here: how many of them this rank has.
    """

    starts: list[int]
    flow: int
    multiplier: Indices
    mode: Indices
    free: Indices
    free_here: int

    @property
    def rows(self) -> int:
        """Of this rank."""
        return self.flow + len(self.multiplier) + self.free_here

    @classmethod
    def of(cls, system: StokesSystem, flow: int) -> _Numbers:
        """Collective."""
        comm, multipliers = system.layout.comm, len(system.layout.on_body)
        free = np.flatnonzero(~system.problem.motion.held.ravel())
        free_here = len(free) if comm.rank == 0 else 0
        first = comm.exscan(flow + multipliers + free_here) or 0
        mode = np.full(system.layout.modes, -1)
        mode[free] = comm.bcast(flow + multipliers) + np.arange(len(free))
        multiplier = first + flow + np.arange(multipliers)
        return cls(comm.allgather(first), flow, multiplier, mode, free, free_here)


type _Triplets = tuple[Indices, Indices, Array]


def _solve(system: StokesSystem) -> NodalSolution:
    layout = system.layout
    prolongation = Prolongation(
        layout, system.rigid, np.zeros_like(system.unknown_modes), eliminate_bodies=False
    )
    cells = CellSum(system.cells, prolongation)
    S, flow, M, b = prolongation.matrix, cells.matrix, cells.constrained, system.b
    numbers = _Numbers.of(system, flow.getLocalSize()[0])
    matrix = _matrix(system, S, flow, numbers)
    loads = multiply_transpose(S, b - M.transpose_times(system.g))
    no_slip = -body_velocity(system, system.problem.motion.U)[layout.on_body]
    on_modes = (mode_equations(system)[1] + law_equations(system)[1])[numbers.free][: numbers.free_here]
    with Factorisation(matrix, layout.dimension) as factors:
        rhs = np.concatenate([loads, no_slip, on_modes])
        solution, residual = (result[..., 0] for result in factors.solve(rhs[:, None]))
    found, traction, free = np.split(solution, [numbers.flow, numbers.flow + len(layout.on_body)])
    x = multiply(S, found) + system.g
    reaction = np.zeros(layout.rows)
    reaction[layout.on_body] = traction
    # The multipliers do not hold M x - b on the rows of walls and of slaves.
    others = ~np.isin(M.rows, layout.on_body)
    reaction[M.rows[others]] = (M.times(x) - b[M.rows])[others]
    U = system.problem.motion.U.copy()
    U.ravel()[numbers.free] = layout.comm.bcast(free.copy())
    for used in (S, flow, matrix):
        used.destroy()
    return NodalSolution(x, reaction, load_of(system, reaction), U, float(residual))


def _matrix(system: StokesSystem, S: PETSc.Mat, flow: PETSc.Mat, numbers: _Numbers) -> PETSc.Mat:
    """The whole matrix, of that of the flow; collective."""
    rows = numbers.rows
    matrix = PETSc.Mat().createAIJ(size=((rows, None), (rows, None)), comm=system.layout.comm)
    none = np.zeros(len(numbers.multiplier))
    trace = _trace(S, system.layout.on_body, numbers)
    rigid = _rigid_columns(system, numbers)
    transposes = [(column, row, value) for row, column, value in (trace, rigid)]
    zero = (numbers.multiplier, numbers.multiplier, none)
    triplets = [
        _renumbered(flow, numbers.starts),
        trace,
        rigid,
        *transposes,
        zero,
        *_of_modes(system, numbers),
    ]
    row, column, value = (np.concatenate([t[k] for t in triplets]) for k in range(3))
    matrix.setPreallocationCOO(row.astype(PETSc.IntType), column.astype(PETSc.IntType))
    matrix.setValuesCOO(value)
    return matrix


def _of_modes(system: StokesSystem, numbers: _Numbers) -> list[_Triplets]:
    """Inertia, and the resistances of laws, on the rank that has the modes."""
    D, K = mode_equations(system)[0], law_equations(system)[0]
    free, number = numbers.free, numbers.mode[numbers.free]
    if not numbers.free_here:
        return []
    if K is None:
        return [(number, number, D[free])]
    entries = K[free][:, free].tocoo()
    return [(number, number, D[free]), (number[entries.row], number[entries.col], entries.data)]


def _renumbered(flow: PETSc.Mat, starts: list[int]) -> _Triplets:
    ranges = flow.getOwnershipRanges()
    start, end = flow.getOwnershipRange()
    indptr, column, value = flow.getValuesCSR()
    row = np.repeat(np.arange(start, end), np.diff(indptr))
    return _shifted(row, ranges, starts), _shifted(column, ranges, starts), value


def _shifted(number: Indices, ranges: Indices, starts: list[int]) -> Indices:
    """From numbers shared out by `ranges` to numbers in which rank k's begin at starts[k]."""
    owner = np.searchsorted(ranges, number, side="right") - 1
    return np.asarray(number - np.asarray(ranges)[owner] + np.asarray(starts)[owner])


def _trace(S: PETSc.Mat, on_body: Indices, numbers: _Numbers) -> _Triplets:
    """-C: the multiplier of a node on a body meets that node's own velocity."""
    indptr, column, _ = S.getValuesCSR()
    velocity = _shifted(column[indptr[on_body]], S.getOwnershipRangesColumn(), numbers.starts)
    return numbers.multiplier, velocity, -np.ones(len(numbers.multiplier))


def _rigid_columns(system: StokesSystem, numbers: _Numbers) -> _Triplets:
    """K."""
    row, mode, value = system.rigid.entries()
    of_row = np.full(system.layout.rows, -1)
    of_row[system.layout.on_body] = numbers.multiplier
    free = numbers.mode[mode] >= 0
    return of_row[row[free]], numbers.mode[mode[free]], value[free]
