"""LDL^T of symmetric matrices, by MUMPS."""

from __future__ import annotations

import fsi.meshes.backend  # noqa: F401

from petsc4py import PETSc


def unfactorised(matrix: PETSc.Mat) -> PETSc.KSP:
    """The solver for a symmetric matrix, whose factors are still to be made."""
    solver = PETSc.KSP().create(matrix.comm)
    solver.setOperators(matrix)
    solver.setType(PETSc.KSP.Type.PREONLY)
    pc = solver.getPC()
    pc.setType(PETSc.PC.Type.CHOLESKY)
    pc.setFactorSolverType("mumps")
    pc.destroy()  # handles hold references: undestroyed they leak megabytes a step in parallel
    return solver


def factorised(stiffness: PETSc.Mat, P: PETSc.Mat) -> PETSc.KSP:
    """Solver for P^T K P, to be destroyed by the caller."""
    inside = stiffness.ptap(P)
    solver = unfactorised(inside)
    solver.setUp()
    inside.destroy()
    return solver
