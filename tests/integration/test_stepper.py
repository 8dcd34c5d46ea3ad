from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.errors import SolveError
from fsi.integration.state import Step
from fsi.lubrication.exact import settling_time
from fsi.models import make_stepper
from tests.exact_model import DiscsBesidePlane, plane_case, settling_case
from tests.integration.stepping import run

SETTLING = json.loads((Path(__file__).parents[1] / "reference" / "settling.json").read_text())


def run_case(case: Case) -> list[Step]:
    return run(make_stepper(case, DiscsBesidePlane(case)), case.configuration())


def gaps(steps: list[Step]) -> Array:
    return np.array([step.state.q.centres[0, 1] - 1.0 for step in steps])


def test_a_disc_turning_in_place_relaxes_exponentially() -> None:
    """Its resistance is constant: from rest under a torque T, `omega = T/R (1 - exp(-R t / I))`."""
    torque, moment = 3.0, 20.0
    body = {
        "name": "disc",
        "radius": 1.0,
        "position": [0.0, 2.0],
        "torque": torque,
        "mass": 1.0,
        "moment_of_inertia": moment,
    }
    case = plane_case([body], 2.0, tolerance=1e-7)
    end = run_case(case)[-1].state
    R = DiscsBesidePlane(case).resistance(end.q)[0, 2]
    rate, final = R / moment, torque / R
    assert end.U[0, 2] == pytest.approx(final * -math.expm1(-rate * 2.0), rel=1e-5)
    # At most 1e-7 radians an accepted step, in about 60 steps.
    assert end.q.angles[0] == pytest.approx(final * (2.0 + math.expm1(-rate * 2.0) / rate), abs=1e-5)
    assert np.all(end.U[0, :2] == 0.0)


def test_a_vanishing_mass_gives_the_motion_without_inertia() -> None:
    light = run_case(settling_case(3.0, tolerance=1e-7, body={"mass": 1e-9, "moment_of_inertia": 1e-9}))
    without = run_case(settling_case(3.0, tolerance=1e-7))
    assert gaps(light)[-1] == pytest.approx(gaps(without)[-1], rel=2e-5)
    assert light[-1].state.U[0, 1] == pytest.approx(without[-1].state.U[0, 1], rel=2e-5)


def test_with_inertia_bodies_start_at_rest_and_held_and_massless_ones_move_at_once() -> None:
    bodies = [
        {"name": "heavy", "radius": 1.0, "position": [0.0, 2.0], "force": [0.0, -1.0], "mass": 1.0},
        {"name": "light", "radius": 1.0, "position": [5.0, 2.0], "force": [0.0, -1.0]},
        {"name": "held", "radius": 1.0, "position": [10.0, 2.0], "velocity": [0.0, -0.1], "mass": 1.0},
    ]
    for body in (bodies[0], bodies[2]):
        body["moment_of_inertia"] = 0.5
    case = plane_case(bodies, 1.0)
    start = run_case(case)[0]
    light = -1.0 / DiscsBesidePlane(case).resistance(case.configuration())[1, 1]
    assert start.state.U[:, 1] == pytest.approx([0.0, light, -0.1], abs=2e-9)
    assert start.instant.F[0, 1] == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize("scheme", ["bogacki-shampine", "adams"])
@pytest.mark.parametrize(("tolerance", "rtol"), [(1e-4, 3e-4), (1e-6, 3e-6)])
@pytest.mark.parametrize("s", [0.1, 0.01])
def test_settling_times(s: float, tolerance: float, rtol: float, scheme: str) -> None:
    """The gap is s at the reference's time; its error, turned into one of time, is a few tolerances."""
    tau = SETTLING["disc"]["tau"][str(s)]
    end = run_case(settling_case(tau, tolerance=tolerance, scheme=scheme))[-1].state
    assert end.t == tau
    assert (end.q.centres[0, 1] - 1.0 - s) / end.U[0, 1] == pytest.approx(0.0, abs=rtol * tau)


@pytest.mark.parametrize("scheme", ["bogacki-shampine", "adams"])
def test_settling_never_touches(scheme: str) -> None:
    steps = run_case(settling_case(213.0, scheme=scheme))
    gap = gaps(steps)
    assert np.all(np.diff(gap) < 0.0)
    assert np.all(gap[1:] >= 0.8 * gap[:-1])
    assert gap[-1] < 1e-4
    assert settling_time(gap[-1], 1.0, 1.0, 1.0, -4 * math.pi) == pytest.approx(213.0, rel=3e-4)


def test_adams_takes_one_solve_a_step_and_is_as_accurate_with_fewer() -> None:
    """Solves and error of the time at the end, of a disc that settles to a gap of 1e-4."""
    solves, late = {}, {}
    for scheme in ("bogacki-shampine", "adams"):
        case = settling_case(213.0, scheme=scheme)
        model = DiscsBesidePlane(case)
        steps = run(make_stepper(case, model), case.configuration())
        gap = float(gaps(steps)[-1])
        solves[scheme] = model.calls
        late[scheme] = abs(settling_time(gap, 1.0, 1.0, 1.0, -4 * math.pi) - 213.0)
        tries = len(steps) + sum(step.rejected for step in steps)
    assert solves["adams"] <= tries
    assert solves["adams"] < 0.6 * solves["bogacki-shampine"]
    assert late["adams"] < late["bogacki-shampine"]


@pytest.mark.parametrize("gap_loss", [0.02, 0.05])
def test_adams_stays_accurate_where_gaps_cut_its_steps(gap_loss: float) -> None:
    """The gaps bound all steps: half as long ones leave less than an eighth of the error."""
    tau = SETTLING["disc"]["tau"]["0.01"]
    late = []
    for loss in (gap_loss, gap_loss / 2):
        steps = run_case(settling_case(tau, tolerance=0.5, gap_loss=loss, scheme="adams", first_step=1e-3))
        gap = gaps(steps)
        assert np.all(gap[1:] >= (1.0 - loss) * gap[:-1])
        late.append(abs(gap[-1] - 0.01) / 0.01)
    assert late[1] < late[0] / 8
    assert late[0] < 1e-4


def test_long_steps_are_rejected_before_the_model_sees_an_overlap() -> None:
    """At rest the present velocity foresees nothing: the stages themselves must be refused."""
    heavy = {"mass": 1e-3, "moment_of_inertia": 1e-3, "force": [0.0, -1000.0]}
    steps = run_case(settling_case(0.5, first_step=0.5, body=heavy))
    assert steps[1].rejected > 0
    gap = gaps(steps)
    assert np.all(gap[1:] >= 0.8 * gap[:-1] * (1 - 1e-12))


def test_a_body_driven_into_a_wall_stops_at_the_smallest_step() -> None:
    case = settling_case(2.0, smallest_step=1e-4, body={"velocity": ["free", -1.0], "force": [0.0, 0.0]})
    stepper = make_stepper(case, DiscsBesidePlane(case))
    with pytest.raises(
        SolveError,
        match=r"smallest_step = 0\.0001: .* t = 0\.99.* disc and wall plane is 0\.00.*; "
        "lower it in a new run, or end the run before$",
    ):
        run(stepper, case.configuration())


def test_steps_land_on_the_kinks_of_the_data_and_on_the_end() -> None:
    table = {"times": [0.0, 0.3, 0.7], "values": [0.0, 1.0, -1.0]}
    case = settling_case(1.0, body={"force": [0.0, 0.0], "torque": table})
    times = [step.state.t for step in run_case(case)]
    assert {0.0, 0.3, 0.7, 1.0} <= set(times)


@pytest.mark.parametrize("scheme", ["bogacki-shampine", "adams"])
def test_the_integral_of_a_table_is_exact(scheme: str) -> None:
    """Between kinks the torque is linear in time, so that both integrate it exactly."""
    table = {"times": [0.0, 0.3, 0.7], "values": [0.0, 1.0, -1.0]}
    case = settling_case(1.0, scheme=scheme, body={"force": [0.0, 0.0], "torque": table})
    end = run_case(case)[-1].state
    R = DiscsBesidePlane(case).resistance(end.q)[0, 2]
    assert end.q.angles[0] == pytest.approx((0.15 + 0.0 - 0.3) / R, rel=1e-13)


def test_a_gap_that_places_no_longer_hold_ends_the_run() -> None:
    """At 1e3 eps |x| = 4.4e-13 beside x = 1; a sphere stood still at 9e-16 for ever, with exit code 0."""
    case = settling_case(2.0, smallest_step=1e-30, body={"velocity": ["free", -1.0], "force": [0.0, 0.0]})
    stepper = make_stepper(case, DiscsBesidePlane(case))
    with pytest.raises(
        SolveError, match=r"disc and wall plane is [1-4]\.\d*e-13, which is lost in the rounding"
    ):
        run(stepper, case.configuration())
