"""Quantities of a motion by name."""

from __future__ import annotations

import csv
import tomllib
from pathlib import Path

import pytest

from fsi.case.load import parse_case
from fsi.errors import SolveError
from fsi.studies.evaluate import of_motion
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
        of_motion(parse_case(data), tmp_path / "few", ["dissipation"])["dissipation"]
    often = parse_case(data | {"output": {"fields": False, "interval": 0.0375}})
    found = of_motion(often, tmp_path / "often", ["dissipation"]).values["dissipation"]
    with (tmp_path / "often" / "steps.csv").open() as file:
        largest = max(float(row["dissipation"]) for row in csv.DictReader(file))
    assert found.value == pytest.approx(largest / 3.0, rel=2e-3)
