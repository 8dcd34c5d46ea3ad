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
    prolong = _scipy(P)
    product = prolong.T.tocsr() @ (_scipy(M) @ prolong)
    product.sort_indices()
    return _petsc(_with_diagonal(product), M.comm.tompi4py())


def _with_diagonal(matrix: sp.csr_matrix) -> sp.csr_matrix:
    """The same with zeros stored where the diagonal has no entry, as SciPy's products drop zeros."""
    n = matrix.shape[0]
    rows = np.repeat(np.arange(n), np.diff(matrix.indptr))
    missing = np.setdiff1d(np.arange(n), rows[rows == matrix.indices], assume_unique=True)
    before = np.flatnonzero(np.isin(rows, missing) & (matrix.indices < rows))
    place = matrix.indptr[missing] + np.bincount(rows[before], minlength=n)[missing]
    indices = np.insert(matrix.indices, place, missing)
    data = np.insert(matrix.data, place, 0.0)
    more = np.zeros(n + 1, dtype=matrix.indptr.dtype)
    more[missing + 1] = 1
    return sp.csr_matrix((data, indices, matrix.indptr + np.cumsum(more)), shape=matrix.shape)


def _scipy(matrix: PETSc.Mat) -> sp.csr_matrix:
    """A copy of a matrix on one rank."""
    return sp.csr_matrix(matrix.getValuesCSR()[::-1], shape=matrix.size)


def _petsc(matrix: sp.csr_matrix, comm: MPI.Intracomm) -> PETSc.Mat:
    """A copy of a matrix on one rank, its rows sorted."""
    indptr, indices = (part.astype(PETSc.IntType) for part in (matrix.indptr, matrix.indices))
    return PETSc.Mat().createAIJ(matrix.shape, csr=(indptr, indices, matrix.data), comm=comm)
