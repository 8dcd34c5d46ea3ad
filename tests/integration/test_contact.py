"""The time of contact from the last decades of a gap, and runs that end with it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.integration.contact import contact_time
from fsi.integration.errors import ErrorEstimate, StepErrors
from fsi.integration.state import Instant
from fsi.postprocess.run.run import open_run
from fsi.report.contact import told_contact
from fsi.runs import resume, run
from tests.exact_model import DiscsBesidePlane, by
from tests.small_run import small_case

GAPS = 0.8 ** np.arange(60.0)


@given(st.floats(0.1, 0.97), st.floats(0.1, 10.0))
@settings(max_examples=30, deadline=None)
def test_a_gap_that_closes_by_a_power_below_1_gives_its_time_of_contact(m: float, K: float) -> None:
    """q^(1 - m) falls at the rate (1 - m) K, from 1 at t = 0."""
    found = contact_time((1.0 - GAPS ** (1.0 - m)) / ((1.0 - m) * K), GAPS)
    assert found is not None
    assert found.exponent == pytest.approx(m, abs=1e-7)
    assert found.time == pytest.approx(1.0 / ((1.0 - m) * K), rel=1e-6)


@pytest.mark.parametrize("m", [1.2, 1.5])
def test_smoother_surfaces_never_meet(m: float) -> None:
    found = contact_time((GAPS ** (1.0 - m) - 1.0) / (m - 1.0), GAPS)
    assert found is not None
    assert found.exponent == pytest.approx(m, abs=1e-7)
    assert found.time == np.inf


def test_errors_cover_what_corrections_of_the_law_change() -> None:
    """-dt/dq = q^(-3/4) (1 + 3 q^(1/2)), as of a tip: contact after 4 + 3 / (3/4) = 8."""
    t = 4.0 * (1.0 - GAPS**0.25) + 4.0 * (1.0 - GAPS**0.75)
    for last in (30, 45, 60):
        found = contact_time(t[:last], GAPS[:last])
        assert found is not None
        assert abs(found.time - 8.0) < found.error < 2.0
        assert abs(found.exponent - 0.75) < found.exponent_error
        assert found.error < 20.0 * GAPS[last - 1] ** 0.5


def test_nothing_is_said_of_a_gap_that_opened_or_hardly_closed() -> None:
    assert contact_time(np.arange(60.0), np.append(GAPS[:58], [0.5, 1e-7])) is None
    assert contact_time(np.arange(4.0), GAPS[:4]) is None


def test_a_run_ends_where_its_gap_comes_to_that_of_contact(tmp_path: Path) -> None:
    """Discs of the closed law -q' ~ q^(3/2): no contact in finite time, and nothing is left to resume."""
    falling = {"name": "disc", "radius": 1.0, "position": [0.0, 2.0], "force": [0.0, -20.0]}
    case = small_case(time={"end": 1e4, "contact_gap": 1e-4}, bodies=[falling])
    outcome = run(case, tmp_path / "run", make=by(DiscsBesidePlane))
    finished = open_run(tmp_path / "run")
    gap = finished.steps["smallest_gap"].to_numpy()
    assert outcome.contact
    assert finished.finished
    assert gap[-1] <= 1e-4 < gap[-2]
    told = told_contact(case, finished.columns("steps"))
    assert told.startswith("no contact in finite time: the gap closes as")
    again = resume(tmp_path / "run", make=by(DiscsBesidePlane))
    assert (again.steps, again.contact) == (0, True)


class TipsBesidePlane(DiscsBesidePlane):
    """Bodies that resist as 10 q^(-3/4), known exactly."""

    def resistance(self, q: Configuration) -> Array:
        R = super().resistance(q)
        R[:, 1] = 10.0 * (q.centres[:, 1] - q.radii) ** -0.75
        return R

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:  # noqa: ARG002
        nothing = np.zeros_like(instant.U)
        return StepErrors(ErrorEstimate(nothing, nothing), {})


@pytest.mark.parametrize("estimated", [True, False])
def test_errors_of_times_of_contact_have_those_of_steps_where_they_are_known(
    estimated: bool, tmp_path: Path
) -> None:
    """From q = 1 under F = 20 after 10/F / (1/4) = 2; long steps miss 5e-3, but follow the law to 1e-11."""
    falling = {"name": "tip", "radius": 1.0, "position": [0.0, 2.0], "velocity": [0.0, "free"]}
    falling |= {"angular_velocity": 0.0, "force": [0.0, -20.0]}
    time = {"end": 4.0, "contact_gap": 1e-4, "tolerance": 1e-2, "gap_loss": 0.5}
    output = {"interval": 4.0, "error_estimates": estimated}
    case = small_case(time=time, bodies=[falling], output=output)
    run(case, tmp_path / "run", make=by(TipsBesidePlane))
    said = told_contact(case, open_run(tmp_path / "run").columns("steps"))
    found, bar = (float(said.split()[k].strip(",")) for k in (4, 6))
    assert (abs(found - 2.0) < bar < 3.0 * abs(found - 2.0)) is estimated
    assert said.endswith("has the errors of steps and elements") is estimated
    assert ("give output.error_estimates = true" in said) is not estimated


CLOSING = {"t": 1.0 - GAPS**0.75, "smallest_gap": GAPS}  # q^(3/4) falls evenly: contact at t = 1


def told(**body: Any) -> str:
    """What is said of such a gap below a disc, which reaches 27 times the last one at t = 0.99941."""
    disc = {"name": "disc", "radius": 1.0, "position": [0.0, 2.0]}
    return told_contact(small_case(bodies=[disc | body]), CLOSING)


def test_a_gap_that_may_close_or_not_is_not_decided() -> None:
    """-dt/dq = (1 - q^(1/2) / 2) / q closes in no time, but its corrections leave m below 1 by their errors.

    It was told as a contact at t = inf, to 0.
    """
    t = -np.log(GAPS) - (1.0 - GAPS**0.5)
    disc = {"name": "disc", "radius": 1.0, "position": [0.0, 2.0], "force": [0.0, -1.0]}
    said = told_contact(small_case(bodies=[disc]), {"t": t[:40], "smallest_gap": GAPS[:40]})
    assert said.startswith("contact in finite time is not decided by q =")


def test_a_drive_that_is_constant_while_the_gap_closes_has_a_time_of_contact() -> None:
    """Also with mass, if the body is held, and after a ramp."""
    heavy = {"mass": 1.0, "moment_of_inertia": 1.0}
    ramp = {"times": [0.0, 0.9], "values": [0.0, -1.0]}
    for body in ({"force": [0.0, -1.0]}, {"force": [0.0, ramp]}):
        assert told(**body).startswith("contact at t = 1 ±")
    assert told(**heavy, velocity=[0.0, -1.0], angular_velocity=0.0).startswith("contact at t = 1 ±")


def test_no_time_of_contact_is_told_where_the_law_of_the_gap_does_not_hold() -> None:
    """A disc with mass that is thrown at a wall never meets it, nor one whose load grows: q ~ impulse^-2."""
    heavy = {"mass": 1.0, "moment_of_inertia": 1.0, "velocity": [0.0, "free"], "angular_velocity": 0.0}
    assert told(**heavy).startswith("contact: its time is not known, as bodies with mass are slowed down")
    growing = {"times": [0.0, 0.9995, 4.0], "values": [-1.0, -10.0, -100.0]}
    for body in ({"force": [0.0, growing]}, {"velocity": [0.0, growing], "angular_velocity": 0.0}):
        assert told(**body).startswith(
            "contact: its time is not known, as loads or velocities change until t = 4"
        )


def test_a_gap_of_contact_that_cannot_be_is_refused_by_name() -> None:
    """A step from 1.25e-8 that closes 0.2 of it, as it may by default, ends at 1e-8; discs start at 0.5."""
    for least in (1e-9, 1e-8):
        words = rf"time\.contact_gap = {least!r}: a step from it ends below 1e-08 radii, .*; give 1\.25e-08"
        with pytest.raises(InputError, match=words):
            small_case(time={"end": 1.0, "contact_gap": least})
    small_case(time={"end": 1.0, "contact_gap": 1.25e-8})
    for least in (0.5, 0.7):
        with pytest.raises(
            InputError, match=rf"time\.contact_gap = {least}: the smallest gap at the start is 0\.5"
        ):
            small_case(time={"end": 1.0, "contact_gap": least})
    bodies = [{"name": "ball", "radius": 1.0, "position": [0.0, 2.0]}]
    data = {"name": "gluey", "model": "gluey", "bodies": bodies, "time": {"end": 1.0, "step": 0.1}}
    data |= {"domain": {"shape": "unbounded"}}
    with pytest.raises(InputError, match=r'time\.contact_gap = 0\.1: model = "gluey" has contacts'):
        parse_case(data | {"time": {"end": 1.0, "step": 0.1, "contact_gap": 0.1}})
