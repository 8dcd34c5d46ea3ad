"""The linear solver: MUMPS LDL^T through PETSc, with the residual always measured."""

from __future__ import annotations

from types import TracebackType

import numpy as np
from petsc4py import PETSc

from fsi.errors import SolveError

REFINE_ABOVE = 1e-14
REFUSE_ABOVE = 1e-9


class Factorisation:
    """LDL^T of a symmetric indefinite matrix, for many right-hand sides; use it in a `with` statement.

    Orderings: minimum degree (ICNTL(7) = 0) and no compression of the graph (ICNTL(12) = 1) are 8 times
    faster than the defaults on Stokes matrices. The matrix must store its whole diagonal.
    """

    def __init__(self, matrix: PETSc.Mat) -> None:
        """Factorise.

        Raises:
            SolveError: the matrix is singular or MUMPS fails.
        """
        self.matrix = matrix
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self._ksp = PETSc.KSP().create(matrix.comm)
        self._ksp.setOperators(matrix)
        self._ksp.setType(PETSc.KSP.Type.PREONLY)
        pc = self._ksp.getPC()
        pc.setType(PETSc.PC.Type.CHOLESKY)
        pc.setFactorSolverType("mumps")
        pc.setFactorSetUpSolverType()
        factor = pc.getFactorMatrix()
        factor.setMumpsIcntl(7, 0)
        factor.setMumpsIcntl(12, 1)
        try:
            self._ksp.setUp()
            status = factor.getMumpsInfog(1)
        except PETSc.Error as error:
            raise SolveError(
                f"MUMPS failed: {error}; is a body or the flow left without anything that holds it?"
            ) from error
        finally:
            # These handles hold references: undestroyed they leak megabytes a step in parallel.
            factor.destroy()
            pc.destroy()
        if status < 0:
            raise SolveError(
                f"MUMPS failed with INFOG(1) = {status}; is the flow left without anything that holds it?"
            )

    def __enter__(self) -> Factorisation:
        """The factorisation itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Free the factors."""
        self._ksp.destroy()

    def solve(self, b: PETSc.Vec) -> tuple[PETSc.Vec, float]:
        """Solution of `M x = b` and its relative residual |b - M x| / |b|, refined if that helps.

        Raises:
            SolveError: the residual is not below 1e-9.
        """
        x, residual, correction = b.duplicate(), b.duplicate(), b.duplicate()
        norm = b.norm()
        if norm == 0.0:
            x.set(0.0)
            relative = 0.0
        else:
            self._ksp.solve(b, x)
            self.matrix.mult(x, residual)
            residual.aypx(-1.0, b)
            relative = residual.norm() / norm
            if REFINE_ABOVE < relative < np.inf:
                self._ksp.solve(residual, correction)
                x.axpy(1.0, correction)
                self.matrix.mult(x, residual)
                residual.aypx(-1.0, b)
                relative = residual.norm() / norm
        residual.destroy()
        correction.destroy()
        if not relative < REFUSE_ABOVE:
            x.destroy()
            raise SolveError(
                f"the linear solve left a relative residual of {relative:.2g} (bound {REFUSE_ABOVE:g})"
            )
        return x, relative
