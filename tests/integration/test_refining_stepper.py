"""Steps that are made again with a finer mesh, and what is said where none is fine enough."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import pytest

from fsi.bodies.configuration import Configuration
from fsi.errors import SolveError
from fsi.integration.errors import StepErrors
from fsi.integration.state import Instant
from fsi.integration.stepper import RefiningStepper, Stepper
from fsi.models import make_stepper
from tests.exact_model import DiscsBesidePlane, plane_case
from tests.integration.stepping import run


class Stubborn(DiscsBesidePlane):
    """Its error is just above the tolerance from t = 1 on, however fine the mesh."""

    tolerance_key: ClassVar[str] = "discretisation.tolerance"
    remedy: str = ", or discretisation.degree (at most 6)"

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:
        known = super().errors(q, t, instant)
        return replace(known, relative={"velocity": 1.404e-4 if t >= 1.0 else 0.0})

    def refine(self, q: Configuration, t: float, instant: Instant) -> None:
        pass


def test_a_step_that_no_mesh_makes_accurate_says_where_and_by_how_much() -> None:
    """The disc goes down at the speed 0.1, from a gap of 1."""
    moves = {"velocity": [0.0, -0.1], "angular_velocity": 0.0}
    case = plane_case([{"name": "disc", "radius": 1.0, "position": [0.0, 2.0], **moves}], 1.0)
    stepper = make_stepper(case, DiscsBesidePlane(case))
    stubborn = Stubborn(case)
    assert isinstance(stepper, Stepper)
    with pytest.raises(SolveError) as missed:
        run(RefiningStepper(replace(stepper, model=stubborn), stubborn, 1.4e-4), case.configuration())
    assert str(missed.value) == (
        "discretisation.tolerance = 0.00014: missed at t = 1, where the error is 0.0001404 with the finest "
        "that was tried, and the smallest gap 0.9; raise it, or discretisation.degree (at most 6), or "
        "end the run before"
    )


def test_a_tolerance_needs_a_model_that_can_be_made_finer() -> None:
    """One whose methods are not those of `Refinable` was stepped as if there were no tolerance."""
    case = plane_case([{"name": "disc", "radius": 1.0, "position": [0.0, 2.0]}], 1.0)
    held = case.model_copy(
        update={"discretisation": case.discretisation.model_copy(update={"tolerance": 1e-4})}
    )
    assert isinstance(make_stepper(held, Stubborn(held)), RefiningStepper)
    with pytest.raises(AssertionError):
        make_stepper(held, DiscsBesidePlane(held))
