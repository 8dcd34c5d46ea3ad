"""Which model a case asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fsi.integration.stepper import Model

if TYPE_CHECKING:
    from fsi.case.case import Case


def make_model(case: Case) -> Model:
    """The model that gives the velocities of the bodies of a case."""
    if case.model == "reduced":
        from fsi.reduced.distance_model import DistanceModel
        from fsi.reduced.model import ReducedModel

        return ReducedModel(case) if case.reduced.step is None else DistanceModel(case, case.reduced.step)
    # dolfinx is imported where it is needed, and only there
    from fsi.stokes.adapt import RefinedModel
    from fsi.stokes.model import StokesModel

    return StokesModel(case) if case.discretisation.tolerance is None else RefinedModel(case)
