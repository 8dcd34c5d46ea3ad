"""The matrices of the discrete Stokes system, and what solves on one mesh share of them while it is moved.

Spaces, the patterns of M, of P and of P^T M P, and MUMPS's analysis of it follow from topology and
constraints alone, and take half the time of a step. A solve finds them again in the workspace that it is
given, where they still fit: the same mesh, the same rows held and tied. Otherwise it begins anew. Values are
always those of the mesh as it is, so that results do not depend on what the workspace had before.
"""

import ctypes
import platform
from contextlib import AbstractContextManager
from dataclasses import fields
from functools import cache

import numpy as np
import scipy.sparse as sp
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, create_matrix
from numpy.typing import NDArray
from petsc4py import PETSc

import fsi.parallel as parallel
from fsi.meshes.build import FluidMesh
from fsi.stokes.discretisation.constraints import DofLayout, Prolongation, RigidModes
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.solvers.mumps import Factorisation


class StokesMatrix:
    """M = [A B^T; B 0] over all nodes, in the order of `DofLayout`; the zeros of its diagonal are stored."""

    def __init__(self, forms: Forms) -> None:
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
        A, numbers = self.A.to_scipy(), np.arange(of_A + len(indices), dtype=np.int32)
        numbered = type(A)((numbers[:of_A].reshape(A.data.shape), A.indices, A.indptr), A.shape).tocsr()
        B = sp.csr_matrix((numbers[of_A:], indices, indptr), self.B.size)
        zero = sp.csr_matrix((np.full(n, of_A + len(indices), np.int32), np.arange(n), np.arange(n + 1)))
        upper, lower = sp.hstack([numbered, B.T.tocsr()], "csr"), sp.hstack([B, zero], "csr")
        pattern = sp.vstack([upper, lower], "csr")
        self._source, self._values = pattern.data.astype(np.intp), np.zeros(pattern.nnz)
        self._every = np.empty(of_A + len(indices) + 1)
        arrays = (*(part.astype(PETSc.IntType, copy=False) for part in (pattern.indptr, pattern.indices)),)
        return PETSc.Mat().createAIJWithArrays(pattern.shape, (*arrays, self._values), comm=self.B.comm)


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


# <malloc.h> of glibc
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
MOST_KEPT, LARGEST = 2**31 - 1, 2**30  # bytes; what exceeds LARGEST still goes back when it is freed


@cache
def keep_freed() -> None:
    """Let glibc keep what one solve frees and the next one wants again, for this process.

    Given back, it would return page by page, cleared: a step of some hundred megabytes loses a twelfth of its
    time so. Elsewhere than on glibc: nothing.
    """
    if platform.libc_ver()[0] == "glibc":
        libc = ctypes.CDLL(None)
        libc.mallopt(M_TRIM_THRESHOLD, MOST_KEPT)
        libc.mallopt(M_MMAP_THRESHOLD, LARGEST)


class Elimination:
    """P, P^T M P and its factors, and the constrained rows of M, of a `layout` with its `unknown` modes."""

    def __init__(
        self, M: PETSc.Mat, layout: DofLayout, rigid: RigidModes, unknown: NDArray[np.bool_]
    ) -> None:
        """Make P and P^T M P; the factors are made when they are wanted."""
        self.layout, self.unknown = layout, unknown
        self._prolongation = Prolongation(layout, rigid, unknown)
        self.P = self._prolongation.matrix
        self.reduced = galerkin(M, self.P)
        first = M.getOwnershipRange()[0]
        self._rows = PETSc.IS().createGeneral((first + layout.constrained).astype(PETSc.IntType), M.comm)
        self.constrained = M.createSubMatrix(self._rows)
        self._factors: Factorisation | None = None

    def update(self, M: PETSc.Mat, rigid: RigidModes) -> None:
        """The same with other values of M and of the rigid modes, in place."""
        self._prolongation.update(rigid)
        galerkin(M, self.P, self.reduced)
        M.createSubMatrix(self._rows, submat=self.constrained)

    def factors(self, *, lasting: bool) -> Factorisation:
        """The factors of `reduced` as it is now, as `Factorisation`. Raises SolveError: it is singular."""
        if self._factors is None:
            self._factors = Factorisation(self.reduced, lasting=lasting)
        else:
            self._factors.update()
        return self._factors

    def destroy(self) -> None:
        """Free the matrices."""
        if self._factors is not None:
            self._factors.destroy()
        for used in (self.constrained, self._rows, self.reduced, self.P):
            used.destroy()


class Workspace(AbstractContextManager["Workspace"]):
    """Keeps what the last solve made; use it in a `with` statement, or `close` it."""

    def __init__(self, *, lasting: bool = True) -> None:
        """Empty; lasting: for many solves."""
        keep_freed()
        self.lasting = lasting
        self._forms: Forms | None = None
        self._stokes: StokesMatrix | None = None
        self._elimination: Elimination | None = None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        parallel.settle(error)
        self.close()

    def close(self) -> None:
        """Free everything; it may be filled again."""
        self.forget_elimination()
        if self._stokes is not None:
            self._stokes.destroy()
        self._forms = self._stokes = None

    def forget_elimination(self) -> None:
        """Free P^T M P, where it has been changed or is not wanted."""
        if self._elimination is not None:
            self._elimination.destroy()
        self._elimination = None

    def forms(self, fluid: FluidMesh, degree: int, viscosity: float) -> Forms:
        """The forms, bound to a mesh that may have moved since."""
        if self._forms is None or not self._forms.fit(fluid, degree, viscosity):
            self.close()
            self._forms = Forms(fluid, degree, viscosity)
            self._stokes = StokesMatrix(self._forms)
        return self._forms

    def stokes_matrix(self) -> PETSc.Mat:
        """M of the forms, on the mesh as it is now; it stays the workspace's."""
        assert self._stokes is not None, "forms come first"
        return self._stokes.assemble()

    def elimination(
        self, M: PETSc.Mat, layout: DofLayout, rigid: RigidModes, unknown: NDArray[np.bool_]
    ) -> Elimination:
        """P and P^T M P; collective. M: the workspace's own."""
        last = self._elimination
        fits = last is not None and np.array_equal(last.unknown, unknown) and _alike(last.layout, layout)
        if last is not None and layout.comm.allreduce(not fits) == 0:
            last.update(M, rigid)
            return last
        self.forget_elimination()
        self._elimination = Elimination(M, layout, rigid, unknown)
        return self._elimination


def _alike(one: DofLayout, other: DofLayout) -> bool:
    """Whether two layouts share the rows out alike, on this rank; how far slaves lie away may differ."""
    names = [part.name for part in fields(DofLayout) if part.name not in ("comm", "away")]
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in names)
