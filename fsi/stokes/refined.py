"""The resolved model of a case with `discretisation.tolerance`: its meshes get finer when they must."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration, Inertia
from fsi.case.case import Case
from fsi.integration.state import Instant
from fsi.observables.error_estimate import StepErrors
from fsi.stokes.adapt import SIZES, refined
from fsi.stokes.error import moved_as_found, step_errors
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

# Bodies move on after a refinement: a tolerance that is just reached would be missed in the next step.
MARGIN = 0.5


class RefinedModel:
    """`StokesModel` with the sizes that the run has needed so far; they never get coarser again."""

    def __init__(self, case: Case) -> None:
        """Begin with the sizes of the case."""
        self.resolved = StokesModel(case)
        self._known: tuple[Instant, StepErrors] | None = None

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> StokesSolution:
        """As `StokesModel`."""
        return self.resolved(q, t, inertia)

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:
        """The estimated errors of an instant; estimated once."""
        if self._known is None or self._known[0] is not instant:
            self._known = instant, step_errors(self.resolved, q, t, instant)
        return self._known[1]

    def refine(self, q: Configuration, t: float, instant: Instant) -> None:
        """Take finer sizes from now on, with which the error at q and t is below MARGIN of the tolerance.

        Raises:
            MeshError, SolveError: of a solve; or the tolerance is out of reach.
        """
        case = self.resolved.case
        tolerance = MARGIN * (case.discretisation.tolerance or 1.0)
        self._use(refined(case, q, t, moved_as_found(case, q, t, instant), tolerance).case)

    def state(self) -> dict[str, NDArray[Any]]:
        """The sizes in use, and what `StokesModel` keeps."""
        given = self.resolved.case.discretisation
        sizes = np.array([float(getattr(given, size)) for size in SIZES])
        return {**self.resolved.state(), "sizes": sizes}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `state` gave."""
        case = self.resolved.case
        values = (type(getattr(case.discretisation, size))(value) for size, value in zip(
            SIZES, state["sizes"], strict=True
        ))  # fmt: skip
        sizes = dict(zip(SIZES, values, strict=True))
        given = case.discretisation.model_copy(update=sizes)
        self._use(case.model_copy(update={"discretisation": given}))
        self.resolved.restore(state)

    def _use(self, case: Case) -> None:
        self.resolved = StokesModel(case)
