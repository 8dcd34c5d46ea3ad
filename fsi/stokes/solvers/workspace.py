"""What solves on one mesh share while it is moved.

Spaces, the patterns of M, of P and of P^T M P, and MUMPS's analysis of it follow from topology and
constraints alone, and take half the time of a step. A solve finds them again in the workspace that it is
given, where they still fit: the same mesh, the same rows held and tied. Otherwise it begins anew. Values are
always those of the mesh as it is, so that results do not depend on what the workspace had before.
"""

from __future__ import annotations

import ctypes
import platform
from contextlib import AbstractContextManager
from dataclasses import fields
from functools import cache

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.meshes.build import FluidMesh
from fsi.stokes.discretisation.constraints import DofLayout, Prolongation, RigidModes
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.discretisation.matrices import StokesMatrix, galerkin
from fsi.stokes.solvers.mumps import Factorisation

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
        """The factors of `reduced` as it is now; lasting: it will change its values many times.

        Raises:
            SolveError: it is singular or MUMPS fails.
        """
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

    def __exit__(self, *_: object) -> None:
        """Free everything."""
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
    return all(
        np.array_equal(getattr(one, part.name), getattr(other, part.name))
        for part in fields(DofLayout)
        if part.name not in ("comm", "away")
    )
