"""The iterative solver of large systems in space: GMRES with a block preconditioner.

With the velocities u and the modes of the bodies together in the first block, the reduced system is

    [ A  B^T ] [ u ]   [ f ]
    [ B   0  ] [ p ] = [ 0 ]

and its preconditioner (Elman, Silvester and Wathen, Finite Elements and Fast Iterative Solvers, section 9.2)

    [ A'  B^T ]                 A' approximates A,  S' the Schur complement B A^-1 B^T (see `schur`)
    [ 0   -S' ]

Away from films that is spectrally equivalent to the mass matrix of the pressure / 2 mu whatever the mesh:
beside that / mu it has eigenvalues s from the square of the inf-sup constant to 1 for gradients of u in place
of its strain rates, and s / (1 + s) for these, whose energy has the square of div u besides.

A' is one cycle of multigrid through velocities of all degrees down to 1 on the same mesh (see `multigrid`),
smoothed before and after by a step of Chebyshev's iteration with incomplete Cholesky factors: the diagonal
alone in their place takes four times the iterations where a mesh has flat cells. A second step saves none, as
S' decides how many there are, but where flat cells spread the eigenvalues: there it saves half. The coarsest
matrix is factorised. So the number of iterations does not grow with the mesh, nor in narrow gaps.

Inertia D stands on the diagonal of modes, in A and A'. In short steps loads D U0 are so large that residuals
relative to them would say nothing of the flow: what D alone makes of loads is taken off first (`_inert`).
"""

from contextlib import AbstractContextManager
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

import fsi.parallel as parallel
from fsi.arrays import Array
from fsi.errors import SolveError, apart
from fsi.stokes.solvers.components import COMPONENTS
from fsi.stokes.solvers.extended import multiply
from fsi.stokes.solvers.multigrid import MOST_FACTORISED, Levels
from fsi.stokes.solvers.schur import SchurComplement

# Of the residual relative to the right-hand side: errors of forces, and of identities, whose bound is 1e-8,
# are up to a few times as large (2e-10 of the force on a sphere beside a plane). In gaps of 1e-3 radii in
# crowds, where pressures are high, the power misses more: such a flow is solved again to SHARPER.
TOLERANCE, SHARPER = 1e-10, 1e-12
MOST_ITERATIONS = 600
RESTART = 150
# Beside narrow gaps the residual that GMRES goes on with falls below the true one: then it starts again.
STARTS = 3

COARSE = "fieldsplit_u_mg_coarse_"
# ICNTL(14): of the workspace that MUMPS reckons with two ranks take up to a third more.
FACTORS: dict[str, str | int] = {
    "ksp_type": "preonly",
    "pc_type": "cholesky",
    "pc_factor_mat_solver_type": "mumps",
    "mat_mumps_icntl_14": 100,
}
# Of more pressures in films. Smoothed by the diagonal alone a gap of 1e-3 radii takes 152 iterations in place
# of 93, with two cycles 74, which elsewhere take as many; with factors 46.
AGGREGATION: dict[str, str | int] = {
    "ksp_type": "preonly",
    "pc_type": "gamg",
    "mg_levels_pc_type": "bjacobi",
    "mg_levels_sub_pc_type": "icc",
    # To square the graph, so as to know what lies within two edges, takes several ranks longer than all else.
    "pc_gamg_aggressive_square_graph": "false",
}
OPTIONS: dict[str, str | int] = {
    "fieldsplit_u_ksp_type": "preonly",
    "fieldsplit_u_pc_type": "mg",
    "fieldsplit_u_mg_levels_pc_type": "bjacobi",
    "fieldsplit_u_mg_levels_sub_pc_type": "icc",
    "fieldsplit_u_mg_levels_ksp_type": "chebyshev",
    "fieldsplit_u_mg_levels_ksp_max_it": 1,
    "fieldsplit_p_ksp_type": "preonly",
}
# The largest eigenvalue with incomplete factors is 1.5 to 1.7, where cells are flat 2.5 to 8: there a second.
SPREAD, STEPS = 2.0, 2


@dataclass(frozen=True, slots=True)
class SchurBlocks:
    """What the preconditioner knows of a reduced system.

    Attributes:
        u: this rank's rows of velocities and modes, global numbers, three to a node.
        p: its rows of pressures.
        levels: the hierarchy of the rows u.
        mass: of the pressures, / 2 mu.
        films: of Reynolds' equation.
        closed: whether a constant pressure changes nothing.
        translations: of all free nodes and bodies, in the rows u, (rows, 3).
        D: inertia on the diagonal of the rows u, (rows,).
    """

    u: NDArray[np.int64]
    p: NDArray[np.int64]
    levels: Levels
    mass: PETSc.Mat
    films: PETSc.Mat
    closed: bool
    translations: Array
    D: Array


class Iteration(AbstractContextManager["Iteration"]):
    """GMRES on a symmetric indefinite matrix of that form; use it in a `with` statement."""

    def __init__(self, matrix: PETSc.Mat, blocks: SchurBlocks, tolerance: float) -> None:
        """Set up; tolerance: of residuals."""
        self.matrix, self.iterations, self._tolerance = matrix, 0, tolerance
        self._closed = blocks.closed
        start = matrix.getOwnershipRange()[0]
        self._constant = matrix.createVecRight()
        self._constant.array[blocks.p - start] = 1.0
        self._constant.normalize()
        if blocks.closed:
            null_space = PETSc.NullSpace().create(vectors=[self._constant], comm=matrix.comm)
            matrix.setNullSpace(null_space)
            null_space.destroy()
        diagonal = matrix.getDiagonal().array[blocks.u - start]
        share, rows = blocks.D / diagonal, matrix.getLocalSize()[0]
        self._of_inertia, self._translations = np.zeros(rows), np.zeros((rows, COMPONENTS))
        self._of_inertia[blocks.u - start] = share / diagonal
        self._translations[blocks.u - start] = blocks.translations * (1.0 - share)[:, None]
        self._of_translations = np.column_stack([multiply(matrix, t) for t in self._translations.T])
        self._ksp = _solver(matrix, blocks)
        self._ksp.setTolerances(rtol=tolerance, max_it=MOST_ITERATIONS)

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        parallel.settle(error)
        self._ksp.destroy()
        self._constant.destroy()

    def solve(self, b: Array) -> tuple[Array, Array]:
        """Solutions of `M x = b` for all columns of b, one after the other; collective.

        b, x: this rank's rows, (rows, k); with x the relative residuals |b - M x| / |b|, (k,), on all ranks,
        with what is left of b when the motion of all and inertia are taken off. Raises SolveError: the
        iteration stagnates.
        """
        solutions, residuals = zip(*(self._solve_one(column) for column in b.T.astype(float)), strict=True)
        return np.column_stack(solutions), np.array(residuals)

    def _solve_one(self, b: Array) -> tuple[Array, float]:
        x, right = self.matrix.createVecs()
        inert, left = self._inert(b)
        c = self._carried(left)
        right.array[:] = left - self._of_translations @ c
        if self._closed:
            right.axpy(-right.dot(self._constant), self._constant)
        size, residual, iterations, relative = right.norm(), right.duplicate(), 0, np.inf
        for start in range(STARTS):
            self._ksp.setInitialGuessNonzero(start > 0)
            self._ksp.solve(right, x)
            iterations += self._ksp.getIterationNumber()
            self.matrix.mult(x, residual)
            residual.axpy(-1.0, right)
            relative = float(residual.norm() / size) if size > 0.0 else 0.0
            if relative <= 2.0 * self._tolerance or self._ksp.getConvergedReason() <= 0:
                break
        self.iterations = max(self.iterations, iterations)
        if self._ksp.getConvergedReason() <= 0 or not relative <= 2.0 * self._tolerance:
            raise SolveError(
                f"the iterative solver stagnates: relative residual {apart(relative, self._tolerance)} after "
                f"{iterations} iterations (bound {self._tolerance:g}); "
                'set discretisation.solver = "direct"'
            )
        values: Array = x.array + self._translations @ c + inert
        for used in (x, right, residual):
            used.destroy()
        return values, relative

    def _inert(self, b: Array) -> tuple[Array, Array]:
        """What inertia alone makes of loads, and those that it leaves; twice, for what rounding leaves."""
        found, left = np.zeros_like(b), b
        for _ in range(2):
            step = self._of_inertia * left
            found, left = found + step, left - multiply(self.matrix, step)
        return found, left

    def _carried(self, b: Array) -> Array:
        """The translation c that leaves least of b, (3,), where that is less than half; else 0; collective.

        Where walls carry everything along alike b is what they do, and forces are a tiny part of it.
        """
        of_rank = np.column_stack([self._of_translations, b])
        gram = of_rank.T @ of_rank
        self.matrix.comm.tompi4py().Allreduce(MPI.IN_PLACE, gram)
        c: Array = np.linalg.lstsq(gram[:-1, :-1], gram[:-1, -1])[0]
        left = gram[-1, -1] - gram[-1, :-1] @ c
        return c if left < 0.25 * gram[-1, -1] else np.zeros_like(c)


def _solver(matrix: PETSc.Mat, blocks: SchurBlocks) -> PETSc.KSP:
    ksp, prefix = PETSc.KSP().create(matrix.comm), "fsi_stokes_"
    ksp.setOptionsPrefix(prefix)
    numbers = (rows.astype(PETSc.IntType) for rows in (blocks.u, blocks.p))
    u, p = parts = [PETSc.IS().createGeneral(rows, matrix.comm) for rows in numbers]
    B, finest = matrix.createSubMatrix(p, u), blocks.levels.matrices[0]
    B_T = B.transpose(PETSc.Mat())
    approximate = PETSc.Mat().createNest(
        [[finest, B_T], [B, blocks.mass]], isrows=parts, iscols=parts, comm=matrix.comm
    )
    ksp.setOperators(matrix, approximate)
    # What is measured is the residual itself, not what the preconditioner makes of it.
    ksp.setType(PETSc.KSP.Type.GMRES)
    ksp.setPCSide(PETSc.PC.Side.RIGHT)
    ksp.setGMRESRestart(RESTART)
    pc = ksp.getPC()
    pc.setType(PETSc.PC.Type.FIELDSPLIT)
    pc.setFieldSplitIS(("u", u), ("p", p))
    pc.setFieldSplitType(PETSc.PC.CompositeType.SCHUR)
    pc.setFieldSplitSchurFactType(PETSc.PC.SchurFactType.UPPER)
    pc.setFieldSplitSchurPreType(PETSc.PC.SchurPreType.USER, blocks.mass)
    options = PETSc.Options(prefix)
    chosen = OPTIONS | {COARSE + name: value for name, value in FACTORS.items()}
    for name, value in chosen.items():
        options[name] = value
    ksp.setFromOptions()
    pc.setUp()
    of_u, of_p = pc.getFieldSplitSubKSP()
    _cycle(of_u.getPC(), blocks.levels)
    of_films = FACTORS if blocks.films.size[0] <= MOST_FACTORISED else AGGREGATION
    of_p.getPC().setType(PETSc.PC.Type.PYTHON)
    of_p.getPC().setPythonContext(SchurComplement(blocks.mass, blocks.films, of_films))
    ksp.setUp()
    of_u.setUp()
    for level in range(1, len(blocks.levels.transfers) + 1):
        _smooth_enough(of_u.getPC().getMGSmoother(level))
    for name in chosen:
        options.delValue(name)
    for used in (*parts, pc, B, B_T, approximate):
        used.destroy()
    return ksp


def _cycle(pc: PETSc.PC, levels: Levels) -> None:
    """One cycle through the levels."""
    pc.setMGLevels(len(levels.matrices))
    for level, transfer in enumerate(reversed(levels.transfers), 1):
        pc.setMGInterpolation(level, transfer)
    coarser = reversed(levels.matrices[1:])
    for level, matrix in enumerate(coarser):
        matrix.setBlockSize(COMPONENTS)
        matrix.setOption(PETSc.Mat.Option.SPD, True)
        smoother = pc.getMGCoarseSolve() if level == 0 else pc.getMGSmoother(level)
        smoother.setOperators(matrix)
    pc.setFromOptions()


def _smooth_enough(smoother: PETSc.KSP) -> None:
    """Have it take STEPS where eigenvalues are spread.

    One step of Chebyshev's iteration, which reckons with 0.1 to 1.1 of the largest eigenvalue, is that of the
    factors over 0.6 of it.
    """
    x, b = smoother.getOperators()[0].createVecs()
    by_factors = x.duplicate()
    b.set(1.0)
    smoother.setUp()
    smoother.solve(b, x)
    smoother.getPC().apply(b, by_factors)
    if by_factors.norm() > 0.6 * SPREAD * x.norm():
        smoother.setTolerances(max_it=STEPS)
    for used in (x, b, by_factors):
        used.destroy()
