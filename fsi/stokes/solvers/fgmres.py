"""The iterative solver of large systems in space: FGMRES with a block preconditioner.

With the velocities u and the modes of the bodies together in the first block, the reduced system is

    [ A  B^T ] [ u ]   [ f ]
    [ B   0  ] [ p ] = [ 0 ]

and its preconditioner (Elman, Silvester and Wathen, Finite Elements and Fast Iterative Solvers, section 9.2)

    [ A'  B^T ]                 A' approximates A,  S' = mass matrix of the pressure / mu
    [ 0   -S' ]

S' is spectrally equivalent to the Schur complement B A^-1 B^T whatever the mesh size. A' is one cycle of
two levels: smoothing on the finite elements themselves, and a correction by velocities of degree 1 that are
rigid on the bodies (see `coarse`), a tenth of the unknowns and less. So the number of iterations does not
grow with the mesh, nor in narrow gaps, where cells are longer than wide: what the coarse space does not know
is within single cells, and there smoothing is fast. The coarse matrix of up to MOST_FACTORISED unknowns is
factorised; beyond, it gets one cycle of smoothed aggregation, which is told the rigid motions of everything.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.bodies.configuration import Array
from fsi.errors import SolveError

TOLERANCE = 1e-12  # of the residual relative to the right-hand side
MOST_ITERATIONS = 600
RESTART = 150
COMPONENTS = 3

MOST_FACTORISED = 120_000
FACTORS = {
    "fieldsplit_u_mg_coarse_pc_type": "cholesky",
    "fieldsplit_u_mg_coarse_pc_factor_mat_solver_type": "mumps",
}
MULTIGRID = {"fieldsplit_u_mg_coarse_pc_type": "gamg"}
OPTIONS = {
    "fieldsplit_u_ksp_type": "preonly",
    "fieldsplit_u_pc_type": "mg",
    "fieldsplit_u_mg_levels_pc_type": "bjacobi",
    "fieldsplit_u_mg_levels_sub_pc_type": "icc",
    "fieldsplit_u_mg_levels_ksp_type": "chebyshev",
    "fieldsplit_u_mg_levels_ksp_max_it": 3,
    "fieldsplit_p_ksp_type": "chebyshev",
    "fieldsplit_p_ksp_max_it": 4,
    "fieldsplit_p_pc_type": "jacobi",
}


@dataclass(frozen=True, slots=True)
class SchurBlocks:
    """What the preconditioner knows of a reduced system.

    Attributes:
        u: this rank's rows of velocities and modes, global numbers, three to a node.
        p: its rows of pressures.
        transfer: from the coarse space to the rows u.
        rigid: the rigid motions of everything in the coarse space, this rank's rows, (rows, 6).
        mass: mass matrix of the pressure / mu.
        closed: whether a constant pressure changes nothing.
    """

    u: NDArray[np.int64]
    p: NDArray[np.int64]
    transfer: PETSc.Mat
    rigid: Array
    mass: PETSc.Mat
    closed: bool


class Iteration(AbstractContextManager["Iteration"]):
    """FGMRES on a symmetric indefinite matrix of that form; use it in a `with` statement."""

    def __init__(self, matrix: PETSc.Mat, blocks: SchurBlocks) -> None:
        """Set up the preconditioner."""
        self.matrix, self.iterations = matrix, 0
        self._closed = blocks.closed
        self._constant = _constant_pressure(matrix, blocks)
        if blocks.closed:
            null_space = PETSc.NullSpace().create(vectors=[self._constant], comm=matrix.comm)
            matrix.setNullSpace(null_space)
            null_space.destroy()
        self._ksp = _solver(matrix, blocks)

    def __exit__(self, *_: object) -> None:
        """Free the preconditioner."""
        self._ksp.destroy()
        self._constant.destroy()

    def solve(self, b: Array) -> tuple[Array, Array]:
        """Solutions of `M x = b` for all columns of b, one after the other; collective.

        Args:
            b: this rank's rows of the right-hand sides, (rows, k).

        Returns:
            this rank's rows of x, (rows, k), and the relative residuals |b - M x| / |b|, (k,), on all ranks.

        Raises:
            SolveError: the iteration stagnates.
        """
        solutions, residuals = zip(*(self._solve_one(column) for column in b.T), strict=True)
        return np.column_stack(solutions), np.array(residuals)

    def _solve_one(self, b: Array) -> tuple[Array, float]:
        x, right = self.matrix.createVecs()
        right.array[:] = b
        if self._closed:
            right.axpy(-right.dot(self._constant), self._constant)
        self._ksp.solve(right, x)
        self.iterations = max(self.iterations, self._ksp.getIterationNumber())
        size = right.norm()
        residual = right.duplicate()
        self.matrix.mult(x, residual)
        residual.axpy(-1.0, right)
        relative = float(residual.norm() / size) if size > 0.0 else 0.0
        if self._ksp.getConvergedReason() <= 0 or not relative <= 2.0 * TOLERANCE:
            raise SolveError(
                f"the iterative solver stagnates: relative residual {relative:.2g} after "
                f"{self._ksp.getIterationNumber()} iterations (bound {TOLERANCE:g}); "
                'set discretisation.solver = "direct", or change the cells in the narrowest gap'
            )
        values: Array = x.array.copy()
        for used in (x, right, residual):
            used.destroy()
        return values, relative


def _constant_pressure(matrix: PETSc.Mat, blocks: SchurBlocks) -> PETSc.Vec:
    """The unit vector of a constant pressure."""
    constant = matrix.createVecRight()
    start, _ = matrix.getOwnershipRange()
    constant.array[blocks.p - start] = 1.0
    constant.normalize()
    return constant


def _solver(matrix: PETSc.Mat, blocks: SchurBlocks) -> PETSc.KSP:
    """FGMRES with the preconditioner set up."""
    ksp = PETSc.KSP().create(matrix.comm)
    prefix = "fsi_stokes_"
    ksp.setOptionsPrefix(prefix)
    ksp.setOperators(matrix)
    ksp.setType(PETSc.KSP.Type.FGMRES)
    ksp.setGMRESRestart(RESTART)
    ksp.setTolerances(rtol=TOLERANCE, max_it=MOST_ITERATIONS)
    pc = ksp.getPC()
    pc.setType(PETSc.PC.Type.FIELDSPLIT)
    u, p = (
        PETSc.IS().createGeneral(rows.astype(PETSc.IntType), matrix.comm) for rows in (blocks.u, blocks.p)
    )
    u.setBlockSize(COMPONENTS)
    pc.setFieldSplitIS(("u", u), ("p", p))
    pc.setFieldSplitType(PETSc.PC.CompositeType.SCHUR)
    pc.setFieldSplitSchurFactType(PETSc.PC.SchurFactType.UPPER)
    pc.setFieldSplitSchurPreType(PETSc.PC.SchurPreType.USER, blocks.mass)
    options = PETSc.Options(prefix)
    chosen = OPTIONS | (MULTIGRID if blocks.transfer.size[1] > MOST_FACTORISED else FACTORS)
    for name, value in chosen.items():
        options[name] = value
    ksp.setFromOptions()
    pc.setUp()
    of_u, of_p = pc.getFieldSplitSubKSP()
    A = of_u.getOperators()[0]
    A.setOption(PETSc.Mat.Option.SPD, True)
    _two_levels(of_u.getPC(), A, blocks)
    of_p.setOperators(blocks.mass, blocks.mass)
    ksp.setUp()
    of_u.setUp()
    for name in chosen:
        options.delValue(name)
    for used in (u, p, pc):
        used.destroy()
    return ksp


def _two_levels(pc: PETSc.PC, A: PETSc.Mat, blocks: SchurBlocks) -> None:
    """One cycle of A smoothed and corrected on the coarse space, whose matrix is T^T A T."""
    pc.setMGLevels(2)
    pc.setMGInterpolation(1, blocks.transfer)
    coarse = A.ptap(blocks.transfer)
    coarse.setBlockSize(COMPONENTS)
    coarse.setOption(PETSc.Mat.Option.SPD, True)
    _tell_rigid_motions(coarse, blocks.rigid)
    pc.getMGCoarseSolve().setOperators(coarse)
    pc.setFromOptions()
    coarse.destroy()
    blocks.transfer.destroy()


def _tell_rigid_motions(A: PETSc.Mat, rigid: Array) -> None:
    """Give the multigrid its near null space: an orthonormal basis of the rigid motions."""
    gram = np.ascontiguousarray(rigid.T @ rigid)
    A.comm.tompi4py().Allreduce(MPI.IN_PLACE, gram)
    orthonormal = np.linalg.solve(np.linalg.cholesky(gram), rigid.T)
    vectors = []
    for values in orthonormal:
        vector = A.createVecRight()
        vector.array[:] = values
        vectors.append(vector)
    null_space = PETSc.NullSpace().create(vectors=vectors, comm=A.comm)
    A.setNearNullSpace(null_space)
    for used in (*vectors, null_space):
        used.destroy()
