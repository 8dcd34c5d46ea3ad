"""The sparse matrices of the discrete Stokes system: M by its blocks, and P^T M P.

Both are made once for a mesh and filled again, in place, while it is moved.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, create_matrix
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.stokes.discretisation.forms import Forms


class StokesMatrix:
    """M = [A B^T; B 0] over all nodes, in the order of `DofLayout`; the zeros of its diagonal are stored."""

    def __init__(self, forms: Forms) -> None:
        """Nothing is assembled yet."""
        self._forms = [[forms.bind("a"), forms.bind("b^T")], [forms.bind("b"), forms.bind("zero")]]
        self._blocks = BlockAssembly(forms) if forms.mesh.comm.size == 1 else None
        self._M: PETSc.Mat | None = None

    def assemble(self) -> PETSc.Mat:
        """M on the mesh as it is now; always the same matrix, which `destroy` frees."""
        if self._blocks is not None:
            self._M = self._blocks.assemble()
        elif self._M is None:
            self._M = assemble_matrix(self._forms, kind="aij")
        else:
            self._M.zeroEntries()
            assemble_matrix(self._M, self._forms)  # type: ignore[arg-type]
        self._M.assemble()
        return self._M

    def destroy(self) -> None:
        """Free the matrices."""
        if self._blocks is not None:
            self._blocks.B.destroy()
        if self._M is not None:
            self._M.destroy()


class BlockAssembly:
    """M on one rank by blocks that are assembled apart: in blocks of d x d, A takes half the time."""

    def __init__(self, forms: Forms) -> None:
        """Make A and B, empty."""
        self._a, self._b = forms.bind("a"), forms.bind("b")
        self.A, self.B = fem.create_matrix(self._a), create_matrix(self._b)
        self._M: PETSc.Mat | None = None

    def assemble(self) -> PETSc.Mat:
        """M, filled in place from the second time on."""
        self.A.set_value(0.0)
        fem.assemble_matrix(self.A, self._a)  # type: ignore[arg-type]
        self.B.zeroEntries()
        assemble_matrix(self.B, self._b)  # type: ignore[arg-type]
        self.B.assemble()
        if self._M is None:
            self._M = self._pattern()
        np.concatenate([self.A.data, self.B.getValuesCSR()[2], [0.0]], out=self._every)
        # Without "clip" numpy would buffer what it takes, at four times the cost.
        np.take(self._every, self._source, out=self._values, mode="clip")
        self._M.stateIncrease()
        return self._M

    def _pattern(self) -> PETSc.Mat:
        """M without its values, and which entry of A or B each of them will be."""
        n, of_A = self.B.size[0], self.A.data.size
        indptr, indices, _ = self.B.getValuesCSR()
        A, of_B = self.A.to_scipy(), _numbers(len(indices), of_A)
        numbered = type(A)((_numbers(of_A, 0).reshape(A.data.shape), A.indices, A.indptr), A.shape).tocsr()
        B = sp.csr_matrix((of_B, indices, indptr), self.B.size)
        zero = sp.csr_matrix((np.full(n, of_A + len(indices), np.int32), np.arange(n), np.arange(n + 1)))
        upper, lower = sp.hstack([numbered, B.T.tocsr()], "csr"), sp.hstack([B, zero], "csr")
        pattern = sp.vstack([upper, lower], "csr")
        self._source, self._values = pattern.data.astype(np.intp), np.zeros(pattern.nnz)
        self._every = np.empty(of_A + len(indices) + 1)
        arrays = (*(part.astype(PETSc.IntType, copy=False) for part in (pattern.indptr, pattern.indices)),)
        return PETSc.Mat().createAIJWithArrays(pattern.shape, (*arrays, self._values), comm=self.B.comm)


def _numbers(count: int, first: int) -> NDArray[np.int32]:
    """first, first + 1, ..."""
    return np.arange(first, first + count, dtype=np.int32)


def pressure_mass(forms: Forms) -> PETSc.Mat:
    """The mass matrix of the pressure over mu."""
    mass = assemble_matrix(forms.bind("pressure mass"))
    mass.assemble()
    return mass


def galerkin(M: PETSc.Mat, P: PETSc.Mat, product: PETSc.Mat | None = None) -> PETSc.Mat:
    """P^T M P; the zeros of its diagonal are stored. product: an earlier one of these patterns, to fill."""
    if M.comm.size > 1:
        return M.ptap(P, result=product)
    options = PETSc.Options()
    options["matptap_via"] = "rap"  # half the time of the default; only on one rank
    try:
        return M.ptap(P, result=product)
    finally:
        options.delValue("matptap_via")
