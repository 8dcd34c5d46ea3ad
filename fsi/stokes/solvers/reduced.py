"""The reduced system P^T M P Y = b of the unknowns Y = (y, z), z those within single cells.

The direct solver factorises only what is left of y when z is eliminated (see `cells`). What is left of the
pressures is their jumps times a mobility, where a level of 1e10 would have to cancel: shut in by gaps of 1e-4
radii, so much of it is lost to rounding that the flow is wrong. So residuals are those of the whole system,
cell by cell, in which pressures meet velocities alone, and the factors only have to come near.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array, Indices
from fsi.stokes.discretisation.cells import StokesCells
from fsi.stokes.discretisation.constraints import DofLayout, Prolongation, RigidModes
from fsi.stokes.discretisation.slip import SlidingFacets
from fsi.stokes.solvers.assembly import CellSum
from fsi.stokes.solvers.extended import ExtendedMatrix, multiply, multiply_transpose
from fsi.stokes.solvers.mumps import Factorisation, Solve


@dataclass(frozen=True, slots=True)
class Added:
    """What comes to P^T M P.

    Attributes:
        D: inertia on the diagonal of all modes, (M N,).
        facets: along which fluid slides, None where it sticks everywhere.
        K: of laws below a gap, of all modes, (M N, M N), None where there are none.
    """

    D: Array
    facets: SlidingFacets | None = None
    K: scipy.sparse.csr_array | None = None

    @property
    def modes(self) -> NDArray[np.bool_]:
        """To which modes something comes, (M N,)."""
        weighed: NDArray[np.bool_] = self.D != 0.0
        return weighed if self.K is None else weighed | (np.diff(self.K.indptr) > 0)


class Elimination:
    """P, the reduced system and its factors, of a `layout` with its `unknown` modes.

    Attributes:
        layout, unknown: what it is of.
        weighed: to which of the unknown modes something comes; these are left.
        first_mode: where the modes stand in Y on rank 0, after all others in y.
        reduced: the matrix of what of y `left` tells, without z and the rest of y.
        left: which of this rank's y groups of cells have not eliminated.
        constrained: the other rows of M.
        allowed: residuals of the modes that suffice, (modes on this rank, k), infinite at first.
    """

    def __init__(
        self,
        cells: StokesCells,
        layout: DofLayout,
        rigid: RigidModes,
        unknown: NDArray[np.bool_],
        added: Added,
    ) -> None:
        """Make P and the matrix; the factors are made when they are wanted."""
        self.layout, self.unknown, self._cells = layout, unknown, cells
        self.weighed = added.modes[unknown]
        self._prolongation = P = Prolongation(layout, rigid, unknown)
        grouped = cells.condensed and layout.dimension == 2 and not layout.sliding
        # Only the iterative solver, whose cells keep their inner unknowns, takes a matrix that is in parts.
        apart = not (cells.condensed or self.weighed.any())
        stays = P.modes[self.weighed]
        self._sum: CellSum | None = CellSum(cells, P, grouped=grouped, apart=apart, stays=stays)
        self._P, self.reduced, self.left = P.matrix, self._sum.matrix, self._sum.left
        self.constrained = self._sum.constrained
        self.first_mode = self._prolongation.here - self._modes_here
        self.allowed: Array = np.full((self._modes_here, 1), np.inf)
        self._factors: Factorisation | None = None
        self._exact: ExtendedMatrix | None = None
        self._sliding: PETSc.Mat | None = None
        self._K = (
            None if added.K is None else added.K[unknown][:, unknown][: self._modes_here, : self._modes_here]
        )
        self._add(added)

    @property
    def _modes_here(self) -> int:
        return int(self.unknown.sum()) if self.layout.comm.rank == 0 else 0

    def _add(self, added: Added) -> None:
        """Put D on the diagonal, and the matrices of sliding surfaces into their places."""
        self._D = added.D[self.unknown][: self._modes_here]
        if added.facets is not None:
            self._add_facets(added.facets)
        weighed = np.flatnonzero(self.weighed[: self._modes_here])
        rows = self.reduced.getOwnershipRange()[0] + (np.cumsum(self.left) - 1)[self.first_mode + weighed]
        for row, value in zip(rows, self._D[weighed], strict=True):
            self.reduced.setValue(row, row, value, PETSc.InsertMode.ADD_VALUES)
        self.reduced.assemble()
        if self._K is not None:
            add_to_modes(self.reduced, rows, self._K[weighed][:, weighed])

    def fits(self, unknown: NDArray[np.bool_], added: Added) -> bool:
        """Whether it may be updated; laws have a pattern of their own at each instant."""
        alike = np.array_equal(self.unknown, unknown) and np.array_equal(self.weighed, added.modes[unknown])
        return self._K is None and added.K is None and alike

    def _add_facets(self, facets: SlidingFacets) -> None:
        P = self._prolongation
        row, column, value = facets.triplets(facets.shared.with_ghosts(P.columns))
        if self._sliding is not None:
            self._sliding.destroy()
        self._sliding = PETSc.Mat().createAIJ(size=((P.here, None), (P.here, None)), comm=P.matrix.comm)
        self._sliding.setPreallocationCOO(row.astype(PETSc.IntType), column.astype(PETSc.IntType))
        self._sliding.setValuesCOO(value)
        self.reduced.axpy(1.0, self._sliding, PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)

    def forget_sum(self) -> None:
        """Free what another sum of the cells would want, more than the matrix itself: no `update` then."""
        self._sum = None

    def update(self, rigid: RigidModes, added: Added) -> None:
        """The same for the mesh and the rigid modes of now, in place."""
        assert self._sum is not None, "the sum is not forgotten"
        self._exact = None
        self._prolongation.update(rigid)
        self._sum.fill()
        self._add(added)

    @property
    def _exact_P(self) -> ExtendedMatrix:
        """P in extended precision."""
        self._exact = self._exact or ExtendedMatrix(self._P)
        return self._exact

    def prolonged(self, Y: Array) -> Array:
        """P Y, (rows, k), for some columns Y, in their precision."""
        here = self._prolongation.here
        product = self._exact_P.times if Y.dtype == np.longdouble else partial(multiply, self._P)
        x = np.column_stack([product(y) for y in Y[:here].T])
        x[self.layout.inner] = Y[here:]
        return x

    def restricted(self, loads: Array) -> Array:
        """P^T of some columns (rows, k), in their precision."""
        is_extended = loads.dtype == np.longdouble
        product = self._exact_P.transpose_times if is_extended else partial(multiply_transpose, self._P)
        y = np.column_stack([product(load) for load in loads.T])
        return np.vstack([y, loads[self.layout.inner]])

    def times(self, Y: Array) -> Array:
        """P^T M P Y with D, for some columns Y, in their precision."""
        product = self.restricted(self._cells.times(self.prolonged(Y)))
        modes = slice(self.first_mode, self._prolongation.here)
        product[modes] += self._D[:, None] * Y[modes]
        if self._K is not None:
            product[modes] += self._K @ Y[modes]
        if self._sliding is not None:
            here = self._prolongation.here
            product[:here] += np.column_stack([multiply(self._sliding, y) for y in Y[:here].T])
        return product

    def solved(self, b: Array, solve: Solve) -> Array:
        """Y for some columns b by the solutions of the reduced matrix."""
        assert self._sum is not None, "the sum is not forgotten"
        if not self._cells.inner:
            return self._sum.solved(b, solve)
        here, inner = self._prolongation.here, self.layout.inner
        loads = np.zeros((self.layout.rows, b.shape[1]))
        loads[inner] = b[here:]
        loads = np.column_stack([self._cells.reduced(load) for load in loads.T])
        y = self._sum.solved(b[:here] + self.restricted(loads)[:here], solve)
        x = self.prolonged(np.vstack([y, b[here:]]))
        every = [self._cells.recovered(*pair)[inner] for pair in zip(x.T, loads.T, strict=True)]
        return np.vstack([y, np.column_stack(every)])

    def misses_loads(self, residual: Array) -> bool:
        """Whether residuals of the modes, the defects of balances, are not `allowed`; collective."""
        of_modes = residual[self.first_mode : self.first_mode + self._modes_here]
        return bool(self.layout.comm.bcast(bool(np.any(np.abs(of_modes) > self.allowed))))

    def tied(self, of_pressures: PETSc.Mat, free: NDArray[np.int64]) -> PETSc.Mat:
        """A matrix of all pressure nodes, summed over images; the same one where none has any; collective.

        free: where pressures stand in y on this rank.
        """
        layout = self.layout
        if layout.comm.allreduce(len(layout.slave)) == 0:
            return of_pressures
        rows = self._P.getOwnershipRange()[0] + np.arange(layout.velocities, layout.rows)
        columns = self._P.getOwnershipRangeColumn()[0] + free
        of_both = [
            PETSc.IS().createGeneral(each.astype(PETSc.IntType), layout.comm) for each in (rows, columns)
        ]
        images = self._P.createSubMatrix(*of_both)
        summed = of_pressures.ptap(images)
        for used in (images, *of_both):
            used.destroy()
        return summed

    def factors(self) -> Factorisation:
        """The factors of `reduced` as it is now, as `Factorisation`. Raises SolveError: it is singular."""
        if self._factors is None:
            self._factors = Factorisation(self.reduced, self.layout.dimension, self)
        else:
            self._factors.update()
        return self._factors

    def destroy(self) -> None:
        """Free the matrices, and what is summed: each refers to the other, which Python finds out late."""
        if self._factors is not None:
            self._factors.destroy()
        for used in (self.reduced, self._P, self._sliding):
            if used is not None:
                used.destroy()
        self._factors = self._sum = None


def add_to_modes(matrix: PETSc.Mat, row: Indices, K: scipy.sparse.csr_array) -> None:
    """Add what couples modes among each other, row: those of a rank's own ones; collective."""
    entries, here = K.tocoo(), matrix.getLocalSize()[0]
    of_modes = PETSc.Mat().createAIJ(size=((here, None), (here, None)), comm=matrix.comm)
    rows, columns = (row[numbers].astype(PETSc.IntType) for numbers in (entries.row, entries.col))
    of_modes.setPreallocationCOO(rows, columns)
    of_modes.setValuesCOO(entries.data)
    matrix.axpy(1.0, of_modes, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    of_modes.destroy()
