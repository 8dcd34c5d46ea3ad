"""The sparse matrices of the discrete Stokes system: M by its blocks, and P^T M P.

On one rank blocks and products are SciPy's, which take half the time of PETSc's there.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI
from petsc4py import PETSc

from fsi.stokes.forms import Forms


def stokes_matrix(forms: Forms) -> PETSc.Mat:
    """M = [A B^T; B 0] over all nodes, in the order of `Layout`; the zeros of its diagonal are stored."""
    if forms.mesh.comm.size > 1:
        blocks = [[forms.bind("a"), forms.bind("b^T")], [forms.bind("b"), forms.bind("zero")]]
        M = assemble_matrix(blocks, kind="aij")
        M.assemble()
        return M
    # Assembled in blocks of 2 x 2, A takes half the time.
    A = fem.assemble_matrix(forms.bind("a")).to_scipy().tocsr()
    divergence = assemble_matrix(forms.bind("b"))
    divergence.assemble()
    B = _scipy(divergence)
    divergence.destroy()
    n = B.shape[0]
    zero = sp.csr_matrix((np.zeros(n), np.arange(n), np.arange(n + 1)), shape=(n, n))
    upper, lower = sp.hstack([A, B.T.tocsr()], "csr"), sp.hstack([B, zero], "csr")
    return _petsc(sp.vstack([upper, lower], "csr"), forms.mesh.comm)


def pressure_mass(forms: Forms) -> PETSc.Mat:
    """The mass matrix of the pressure over mu."""
    mass = assemble_matrix(forms.bind("pressure mass"))
    mass.assemble()
    return mass


def galerkin(M: PETSc.Mat, P: PETSc.Mat) -> PETSc.Mat:
    """P^T M P; the zeros of its diagonal are stored."""
    if M.comm.size > 1:
        return M.ptap(P)
    prolong, full = _scipy(P), _scipy(M)
    # SciPy's products drop zeros; ones keep the places of those on the diagonal meanwhile.
    empty = full.diagonal() == 0.0
    full.setdiag(np.where(empty, 1.0, full.diagonal()))
    product = prolong.T.tocsr() @ (full @ prolong)
    product.sort_indices()
    product.setdiag(np.where(prolong.T @ empty > 0.0, 0.0, product.diagonal()))
    return _petsc(product, M.comm.tompi4py())


def _scipy(matrix: PETSc.Mat) -> sp.csr_matrix:
    """A copy of a matrix on one rank."""
    return sp.csr_matrix(matrix.getValuesCSR()[::-1], shape=matrix.size)


def _petsc(matrix: sp.csr_matrix, comm: MPI.Intracomm) -> PETSc.Mat:
    """A matrix on one rank, its rows sorted, with the same arrays."""
    indptr, indices = (part.astype(PETSc.IntType, copy=False) for part in (matrix.indptr, matrix.indices))
    return PETSc.Mat().createAIJWithArrays(matrix.shape, (indptr, indices, matrix.data), comm=comm)
