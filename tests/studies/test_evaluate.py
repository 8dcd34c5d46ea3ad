"""Quantities of a motion by name."""

from __future__ import annotations

import csv
import tomllib
from pathlib import Path

import numpy as np
import pytest

from fsi.case.load import parse_case
from fsi.errors import SolveError
from fsi.studies.evaluate import mean_over_time, of_motion
from tests.small_run import rows

PUSHED = """
name = "two spheres that are pushed together"
geometry = "axisymmetric"
model = "reduced"
fluid.viscosity = 1.0
domain = { shape = "round", radius = 100.0 }
reduced.wall_law = "leading"
time = { end = 8.0, tolerance = 1e-2 }
bodies = [
    { name = "upper", radius = 1.0, position = [0.0, 1.25], force = [0.0, -2.0] },
    { name = "lower", radius = 1.0, position = [0.0, -1.25], velocity = [0.0, 0.0] },
]
"""


def test_the_force_at_the_end_of_a_run_is_that_of_the_fluid(tmp_path: Path) -> None:
    """Of two spheres that are pushed together; the gap of 0.5 falls below 0.3 between two steps."""
    case = parse_case(tomllib.loads(PUSHED))
    found = of_motion(case, tmp_path / "run", ["upper.force.z", "time at gap 0.3"]).values
    assert found["upper.force.z"].value == pytest.approx(2.0, rel=1e-9)  # the push is -2
    steps = rows(tmp_path / "run" / "steps.csv")
    gaps = [float(step["smallest_gap"]) for step in steps]
    after = next(k for k, gap in enumerate(gaps) if gap < 0.3)
    t = [float(step["t"]) for step in steps]
    assert t[after - 1] < found["time at gap 0.3"].value < t[after]


def test_means_of_long_steps_follow_what_bends() -> None:
    """(1/2 + 3t/2)^2 has the mean 7/4; by straight lines between these steps of a run it is 1.81."""
    t = np.array([0.0, 0.17, 0.52, 1.0])
    found = mean_over_time(t, (0.5 + 1.5 * t) ** 2)
    assert found.value == pytest.approx(1.75, rel=1e-3)
    assert found.error == pytest.approx(1.8094 - 1.75, rel=0.05)


@pytest.mark.parametrize(("loss", "error"), [(0.2, 1e-3), (0.5, 0.04), (0.6, 0.09)])
def test_means_towards_contact_stay_between_the_steps(loss: float, error: float) -> None:
    """q^(-3/2) of a gap q = 1 - t that loses a part in each step; splines were 34 times too large at 0.5."""
    q = (1.0 - loss) ** np.arange(np.ceil(np.log(1e-5) / np.log1p(-loss)) + 1.0)
    exact = 2.0 * (q[-1] ** -0.5 - 1.0) / (1.0 - q[-1])
    found = mean_over_time(1.0 - q, q**-1.5)
    assert found.error is not None
    assert abs(found.value - exact) < min(found.error, error * exact)


def test_means_do_not_go_round_kinks() -> None:
    """|t - 1| from 0 to 3 has the mean 5/6; one monotone cubic through its steps is 4 % off."""
    t = np.array([0.0, 0.4, 1.0, 1.3, 2.0, 3.0])
    assert mean_over_time(t, np.abs(t - 1.0), (1.0, 7.0)).value == pytest.approx(5.0 / 6.0, rel=1e-14)
    assert mean_over_time(t, np.abs(t - 1.0)).value != pytest.approx(5.0 / 6.0, rel=1e-3)


def test_a_mean_of_what_is_infinite_is_no_number_to_go_on_with() -> None:
    assert mean_over_time(np.array([0.0, 1.0, 2.0]), np.array([1.0, np.inf, 1.0])).value == np.inf
    assert mean_over_time(np.zeros(1), np.array([2.0])).value == 2.0


def test_a_square_of_which_only_the_ends_are_known_is_refused(tmp_path: Path) -> None:
    """A lid that goes to and fro at 1 and -1 dissipates a third of what it does at both ends."""
    lid = {"times": [0.0, 0.3, 0.7, 1.0], "values": [0.0, 1.0, -1.0, 0.0]}
    data = {
        "name": "to and fro", "model": "pores", "fluid": {"viscosity": 1.0}, "pores": {"modes": 0},
        "domain": {"lower": [0.0, 0.0], "upper": [7.0, 6.0], "periodic": ["x"], "walls": {"top": [lid, 0.0]}},
        "bodies": [{"name": "disc", "radius": 1.0, "position": [3.5, 3.0], "velocity": [0.0, 0.0]}],
        "time": {"end": 1.0}, "output": {"fields": False},
    }  # fmt: skip
    with pytest.raises(SolveError, match=r"no step between t = 0 and 0\.3; give output\.interval = 0\.0375$"):
        of_motion(parse_case(data), tmp_path / "few", ["dissipation"])
    often = parse_case(data | {"output": {"fields": False, "interval": 0.0375}})
    found = of_motion(often, tmp_path / "often", ["dissipation"]).values["dissipation"]
    with (tmp_path / "often" / "steps.csv").open() as file:
        largest = max(float(row["dissipation"]) for row in csv.DictReader(file))
    assert found.value == pytest.approx(largest / 3.0, rel=2e-3)
