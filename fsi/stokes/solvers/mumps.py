"""The linear solver: MUMPS LDL^T through PETSc, with the residual always measured.

A residual r = b - M x is measured by what it does to the result,

    eps = sum_i |x_i r_i| / sum_i |x_i b_i|.

For symmetric M the power of the loads is wrong by `b.(M^-1 b - x) = (M^-1 b).r`, so that eps bounds its
relative error: that of the force on a body that moves, or of the velocity of one that is pushed. It depends
on no units. |r| / |b| would, and at a gap of 1e-8 radii pressures are so large that storing x in double
precision alone leaves 1e-8 in it, whatever the solver does, while forces are right to 1e-14; eps then is 2e-9
at first and 5e-15 after one refinement in working precision (Skeel 1980, Math. Comp. 35:817).

Beside a body in a narrow gap, which takes 1e5 times as much, eps says nothing of the load of another one. So
an operator also tells which residuals are too large for the loads that its rows are of.

Where nothing but friction mu / b on walls holds fluid and bodies they move with a velocity of size b, all
alike. To store that in doubles leaves residuals of 1e-16 b at every node, whose power counts although the
forces in the flow are of the order of one: eps is 7e-9 at b = 1e4. So what double precision leaves too large
is solved in extended precision, which has 3e-4 of these.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Protocol

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

import fsi.parallel as parallel
from fsi.arrays import Array
from fsi.errors import RefusedError, SolveError, apart
from fsi.meshes.moving.slip import unfactorised
from fsi.stokes.solvers.refinement import correction

# ICNTL(7). In the plane approximate minimum fill: light meshes of 50 to 1000 discs take 0.67 to 0.75 of the
# operations of minimum degree, few bodies as many; nested dissection saves no more and takes twice as long to
# order. In space nested dissection by METIS: minimum fill takes 1.8 times the operations for 16^3 points, 3.5
# times for two spheres in a box with 67,000 unknowns.
ORDERS = {2: 2, 3: 5}
# ICNTL(8): by the roots of the diagonal, where inner unknowns have left no zeros. It delays as few pivots and
# leaves the same residuals as MUMPS's own choice, which goes over the matrix many times: a tenth of its time.
# MUMPS leaves it out, without a word, where several ranks have rows of the matrix, and then delays three
# quarters of the pivots of quintic elements and runs out of workspace: there it scales rows and columns.
SCALED_BY_DIAGONAL, SCALED_BY_ROWS = 1, 7
# Percent beyond MUMPS's estimate: many delayed pivots may need the second, and those of a free body in a
# narrow gap, in the form with multipliers, the last.
WORKSPACES = (30, 500, 5000)
TOO_LITTLE_WORKSPACE = (-8, -9)
SINGULAR = (-6, -10)
# A residual of 3e-13 left a momentum defect of 1e-8 where cells halve towards corners; refined, of 3e-11. Of
# hundreds of sheared discs one of 1e-13 leaves 1e-15, and refining it would take a tenth of a step.
REFINE_ABOVE, REFINE_AT_FIRST_ABOVE = 1e-13, 1e-12
MEND_ABOVE, MEND_EXTENDED_ABOVE = 1e-12, 1e-18
REFUSE_ABOVE = 1e-9
CYCLES, WORTHWHILE = 4, 0.5
LEFT = "left without anything that holds it"

type Solve = Callable[[Array], Array]


class Operator(Protocol):
    """What a factorised matrix stands for, on this rank's rows of some columns; collective."""

    def times(self, x: Array) -> Array:
        """Its product, in the precision of x."""
        ...

    def solved(self, b: Array, solve: Solve) -> Array:
        """Its solutions up to rounding, by those of the matrix."""
        ...

    def misses_loads(self, residual: Array) -> bool:
        """Whether residuals are too large for a load, however small they are beside the others."""
        ...


class Factorisation(AbstractContextManager["Factorisation"]):
    """LDL^T of a symmetric indefinite matrix, for many right-hand sides; use it in a `with` statement.

    Such an ordering and no compression of the graph (ICNTL(12) = 1) are 8 times faster than the defaults on
    Stokes matrices. The matrix must store its whole diagonal.
    """

    def __init__(self, matrix: PETSc.Mat, dimension: int, operator: Operator | None = None) -> None:
        """Factorise, as `update`.

        dimension: of the mesh. operator: what the solutions and residuals are of; None: the matrix itself, in
        double precision.
        """
        self._operator, self._order = operator, ORDERS[dimension]
        self.matrix, self.iterations, self.extended = matrix, 0, False
        self.refine_above = REFINE_ABOVE
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self._ksp = _solver(matrix, self._order, WORKSPACES[0])
        self.update()

    def update(self) -> None:
        """Factorise the matrix as it is now, of the same pattern. Raises SolveError: it is singular."""
        self._ksp.setOperators(self.matrix)  # or PETSc would not look at its values again
        status = _factorise(self._ksp)
        for more in WORKSPACES[1:]:
            if status not in TOO_LITTLE_WORKSPACE:
                break
            self._ksp.destroy()
            self._ksp = _solver(self.matrix, self._order, more)
            status = _factorise(self._ksp)
        if status < 0:
            raise SolveError(f"MUMPS failed with INFOG(1) = {status}, {_meaning(status)}")

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        parallel.settle(error)
        self.destroy()

    def destroy(self) -> None:
        """Free the factors."""
        self._ksp.destroy()

    def solve(self, b: Array) -> tuple[Array, Array]:
        """Solutions of `M x = b`, refined if that helps, for all columns of b at once; collective.

        b, x: this rank's rows, (rows, k); with x the residuals, measured as above, (k,), on all ranks. A
        block of some tens costs a tenth of as many single ones. With `extended`, or where doubles leave too
        much, x is of extended precision. Refined are residuals above `refine_above`, or that miss a load.
        Raises RefusedError: a residual is not below 1e-9.
        """
        x, relative = self._solved(b, extended=self.extended)
        has_more_digits = self._operator is not None and not self.extended
        if has_more_digits and not relative.max() < REFUSE_ABOVE:
            x, relative = self._solved(b, extended=True)
        if not relative.max() < REFUSE_ABOVE:
            size = f"{apart(relative.max(), REFUSE_ABOVE)}, more than {REFUSE_ABOVE:g}"
            raise RefusedError(f"the linear solve left a relative residual of {size}")
        return x, relative

    def _solved(self, b: Array, *, extended: bool) -> tuple[Array, Array]:
        """Solutions and residuals, however large these are."""
        exact, b = b, b.astype(float, copy=False)
        x = self._apply(b)
        residual = b - self._multiply(x)
        relative = self._measured(residual, x, b)
        refine = relative.max() > self.refine_above or self._misses_loads(residual)
        if refine and relative.max() < np.inf:
            x += self._apply(residual)
            relative = self._measured(b - self._multiply(x), x, b)
        enough = MEND_EXTENDED_ABOVE if extended else MEND_ABOVE
        if extended:
            x, b = x.astype(np.longdouble), exact.astype(np.longdouble)
        for k in np.flatnonzero((extended | (relative > MEND_ABOVE)) & (relative < np.inf)):
            x[:, k], relative[k] = self._mended(x[:, k], b[:, k], enough)
        return x, relative

    def _mended(self, x: Array, b: Array, enough: float) -> tuple[Array, float]:
        """A solution (rows,) that one refinement has not brought to rounding, and its residual."""

        def apply(residual: Array) -> Array:
            return self._apply(residual[:, None])[:, 0]

        def multiply(x: Array) -> Array:
            return self._multiply(x[:, None])[:, 0]

        best, least = x, np.inf
        residual = b - multiply(x)
        for _ in range(CYCLES):
            d = apply(residual.astype(float, copy=False))
            x = x + correction(lambda z: apply(multiply(z)), d, self._total)
            residual = b - multiply(x)
            relative = float(self._measured(residual[:, None], x[:, None], b[:, None])[0])
            if not relative < least:
                break
            gained = relative < WORTHWHILE * least
            best, least = x, relative
            if least <= enough or not (gained or least >= REFUSE_ABOVE):
                break
        return best, least

    def _total(self, here: Array) -> Array:
        """The sum over all ranks."""
        return np.asarray(MPI.COMM_WORLD.allreduce(here, op=MPI.SUM))

    def _apply(self, b: Array) -> Array:
        """The factors' solution of M x = b, not refined."""
        return self._solve(b) if self._operator is None else self._operator.solved(b, self._solve)

    def _misses_loads(self, residual: Array) -> bool:
        """As the operator says, the same on all ranks."""
        return self._operator is not None and self._operator.misses_loads(residual)

    def _solve(self, b: Array) -> Array:
        right, x = self._dense(b), self._dense(np.zeros_like(b))
        pc = self._ksp.getPC()
        factor = pc.getFactorMatrix()
        factor.matSolve(right, x)
        return self._taken(x, right, factor, pc)

    def _multiply(self, x: Array) -> Array:
        if self._operator is not None:
            return self._operator.times(x)
        right = self._dense(x)
        return self._taken(self.matrix.matMult(right), right)

    def _dense(self, values: Array) -> PETSc.Mat:
        rows, columns = values.shape
        dense = PETSc.Mat().createDense(((rows, None), (None, columns)), comm=self.matrix.comm)
        dense.setUp()
        dense.getDenseArray()[:] = values
        dense.assemble()
        return dense

    @staticmethod
    def _taken(dense: PETSc.Mat, *used: PETSc.Object) -> Array:
        """This rank's rows of a dense matrix, which is destroyed with everything it came from."""
        values: Array = dense.getDenseArray().copy()
        for handle in (dense, *used):
            handle.destroy()
        return values

    def _measured(self, residual: Array, x: Array, b: Array) -> Array:
        """The measure of each column's residual, on all ranks; 0 without a load."""
        sums = self._total(np.array([np.abs(x * part).sum(axis=0) for part in (residual, b)]))
        return np.asarray(sums[0] / np.where(sums[1] == 0.0, 1.0, sums[1]))


def _solver(matrix: PETSc.Mat, order: int, workspace: int) -> PETSc.KSP:
    """A solver without factors yet; order: of elimination; workspace: beyond MUMPS's estimate, in percent."""
    ksp = unfactorised(matrix)
    pc = ksp.getPC()
    pc.setFactorSetUpSolverType()
    factor = pc.getFactorMatrix()
    scaling = SCALED_BY_DIAGONAL if matrix.comm.size == 1 else SCALED_BY_ROWS
    for option, value in ((7, order), (8, scaling), (12, 1), (14, workspace)):
        factor.setMumpsIcntl(option, value)
    # These handles hold references: undestroyed they leak megabytes a step in parallel.
    factor.destroy()
    pc.destroy()
    return ksp


def _meaning(status: int) -> str:
    """Of a negative INFOG(1) (MUMPS 5 users' guide, section 8), and what to do."""
    if status in SINGULAR:
        return f"a singular matrix: is a body or the flow {LEFT}? hold a body or give a wall a velocity"
    return (
        "most likely too little memory: lower discretisation.cells_per_circle or degree, raise growth, "
        'or in space set discretisation.solver = "iterative"'
    )


def _factorise(ksp: PETSc.KSP) -> int:
    """Factorise the matrix of a solver, and MUMPS's status."""
    pc = ksp.getPC()
    factor = pc.getFactorMatrix()
    try:
        ksp.setUp()
        return int(factor.getMumpsInfog(1))
    except PETSc.Error as error:
        raise SolveError(f"MUMPS failed: {error}; is a body or the flow {LEFT}?") from error
    finally:
        factor.destroy()
        pc.destroy()
