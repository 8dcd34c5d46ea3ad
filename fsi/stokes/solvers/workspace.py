"""The matrices of the discrete Stokes system, and what solves on one mesh share of them while it is moved.

Spaces, the patterns of P and of P^T M P, and MUMPS's analysis of it follow from topology and
constraints alone, and take half the time of a step. A solve finds them again in the workspace that it is
given, where they still fit: the same mesh, the same rows held and tied. Otherwise it begins anew. Values are
always those of the mesh as it is, so that results do not depend on what the workspace had before.
"""

from contextlib import AbstractContextManager
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

import fsi.parallel as parallel
from fsi.machine.heap import keep_freed
from fsi.meshes.build import FluidMesh
from fsi.stokes.discretisation.cells import StokesCells
from fsi.stokes.discretisation.constraints import DofLayout, RigidModes
from fsi.stokes.discretisation.forms import Forms
from fsi.stokes.solvers.reduced import Added, Elimination


class Workspace(AbstractContextManager["Workspace"]):
    """Keeps what the last solve made; use it in a `with` statement, or `close` it."""

    def __init__(self) -> None:
        """Empty."""
        keep_freed()
        self._forms: Forms | None = None
        self._cells: StokesCells | None = None
        self._elimination: Elimination | None = None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        parallel.settle(error)
        self.close()

    def close(self) -> None:
        """Free everything; it may be filled again."""
        self.forget_elimination()
        self._forms = self._cells = None

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
        return self._forms

    def cells(self, *, condensed: bool) -> StokesCells:
        """The cells of the forms, as `StokesCells`; collective."""
        assert self._forms is not None, "forms come first"
        if self._cells is None or self._cells.condensed != condensed:
            self.forget_elimination()
            self._cells = StokesCells(self._forms, condensed=condensed)
        return self._cells

    def elimination(
        self, layout: DofLayout, rigid: RigidModes, unknown: NDArray[np.bool_], added: Added
    ) -> Elimination:
        """The reduced system of the workspace's cells, as `Elimination`; collective."""
        assert self._cells is not None, "cells come first"
        last = self._elimination
        fits = last is not None and last.fits(unknown, added) and _alike(last.layout, layout)
        if last is not None and layout.comm.allreduce(not fits) == 0:
            last.update(rigid, added)
            return last
        self.forget_elimination()
        self._elimination = Elimination(self._cells, layout, rigid, unknown, added)
        return self._elimination


def _alike(one: DofLayout, other: DofLayout) -> bool:
    """Whether two layouts share the rows out alike, on this rank; how far slaves lie away may differ."""
    names = [part.name for part in fields(DofLayout) if part.name not in ("comm", "away")]
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in names)
