"""Bars of positions, gaps and times of a run hold, and are not absurdly long, by a model of NumPy only."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from fsi.bodies.configuration import Array, Configuration, Inertia
from fsi.case.case import Case
from fsi.integration.errors import ErrorEstimate, StepErrors
from fsi.integration.evolution import Moment, SteppedEvolution
from fsi.integration.state import Instant
from fsi.models import stepped
from tests.exact_model import DiscsBesidePlane, ExactInstant, settling_case

SAFETY = 1.5


@dataclass
class Inexact(DiscsBesidePlane):
    """Velocities that miss by a part of themselves, and bars that say so."""

    part: float = 0.0

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> ExactInstant:
        exact = super().__call__(q, t, inertia)
        return ExactInstant(exact.U * (1.0 - self.part), exact.F, exact.record)

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:  # noqa: ARG002
        delta = SAFETY * self.part / (1.0 - self.part) * instant.U
        return StepErrors(ErrorEstimate(np.abs(delta), np.zeros_like(delta)), {}, delta)


def moments(evolution: SteppedEvolution) -> list[Moment]:
    found = [evolution.start()]
    while found[-1].state.t < evolution.schedule.end:
        found.append(evolution.advance(found[-1].state))
    return found


def with_bars(case: Case) -> Case:
    return case.model_copy(update={"output": case.output.model_copy(update={"error_estimates": True})})


def disc(end: float, start: float, force: tuple[float, float], **time: Any) -> Case:
    body = {"position": [0.0, start], "force": list(force), "torque": 1.0}
    return with_bars(settling_case(end, body=body, **time))


def ratios(case: Case, part: float) -> tuple[Array, float]:
    """Error over bar of x, y, angle at the end, and of the gap."""
    last = moments(stepped(case, Inexact(case, part=part)))[-1]
    assert case.time is not None
    fine = case.model_copy(update={"time": case.time.model_copy(update={"tolerance": 1e-9})})
    exact = moments(stepped(fine, DiscsBesidePlane(fine)))[-1].state.q
    q, columns = last.state.q, last.record.body_columns
    errors = np.abs([*(q.centres - exact.centres)[0], q.angles[0] - exact.angles[0]])
    bars = np.array([columns[f"err_{name}"][0] for name in ("x", "y", "angle")])
    of_gap = abs(last.record.smallest_gap - (exact.centres[0, 1] - 1.0))
    return errors / bars, of_gap / last.record.columns["err_smallest_gap"]


PULL = 4.0 * math.pi


@pytest.mark.parametrize(
    ("start", "force"), [(1.5, (2.0, -PULL)), (1.02, (2.0, PULL))], ids=["settles", "is pulled away"]
)
@pytest.mark.parametrize(("part", "tolerance"), [(1e-3, 1e-6), (1e-4, 1e-2), (0.0, 1e-2)])
def test_bars_of_positions_and_gap_hold(
    start: float, force: tuple[float, float], part: float, tolerance: float
) -> None:
    """Of the elements, of both, of the steps alone; in the gap errors decay, on the way out they grow.

    Without J e the bar of the angle in the last one that settles is 4 times too short.
    """
    found, of_gap = ratios(disc(3.0, start, force, tolerance=tolerance), part)
    assert np.all(found < 1.0)
    assert of_gap < 1.0
    if part >= 1e-3:
        assert np.all(found > 0.5)
        assert of_gap > 0.5


def test_a_resumed_run_has_strayed_as_far() -> None:
    case = disc(1.0, 1.5, (1.0, -PULL), tolerance=1e-3)
    whole = moments(stepped(case, Inexact(case, part=1e-3)))
    first, again = (stepped(case, Inexact(case, part=1e-3)) for _ in range(2))
    state = first.advance(first.start().state).state
    again.restore(first.memory())
    assert again.advance(state).record.body_columns["err_y"] == whole[2].record.body_columns["err_y"]


def test_held_bodies_do_not_stray() -> None:
    case = with_bars(
        settling_case(0.1, body={"velocity": [0.0, -1.0], "angular_velocity": 0.0, "force": [0.0, 0.0]})
    )
    last = moments(stepped(case, Inexact(case)))[-1]
    assert last.record.body_columns["err_y"] < 1e-15
    assert last.record.columns["err_smallest_gap"] < 1e-15
