"""Symmetric positive definite systems of the mesh, by MUMPS."""

from __future__ import annotations

import meshes.backend  # noqa: F401

from petsc4py import PETSc


def factorised(stiffness: PETSc.Mat, P: PETSc.Mat) -> PETSc.KSP:
    """Solver for P^T K P, to be destroyed by the caller."""
    inside = stiffness.ptap(P)
    solver = PETSc.KSP().create(inside.comm)
    solver.setOperators(inside)
    solver.setType(PETSc.KSP.Type.PREONLY)
    pc = solver.getPC()
    pc.setType(PETSc.PC.Type.CHOLESKY)
    pc.setFactorSolverType("mumps")
    solver.setUp()
    pc.destroy()
    inside.destroy()
    return solver
