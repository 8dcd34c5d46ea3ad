"""Quantities of a motion by name."""

from __future__ import annotations

import csv
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from fsi.case.case import Case
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


ONE = """
name = "a disc beside a plane"
model = "reduced"
fluid.viscosity = 1.0
domain = { shape = "half-plane", radius = 1000.0 }
reduced = { law = "exact", drag = 5.0 }
output.fields = false
"""


def test_the_time_at_a_gap_of_a_run_knows_its_kinks(tmp_path: Path) -> None:
    """A disc goes down at 0.8 until t = 1 and is braked until 1.02; round the kink it was 1.06 at 0.21."""
    fall = "[0.0, { times = [1.0, 1.02], values = [-0.8, -0.02] }]"
    body = f'bodies = [{{ name = "a", radius = 1.0, position = [0.0, 2.0], velocity = {fall} }}]\n'
    case = parse_case(tomllib.loads(ONE + body + "time.end = 3.0"))
    found = of_motion(case, tmp_path / "run", ["time at gap 0.21"]).values
    value, error = found["time at gap 0.21"].value, found["time at gap 0.21"].error
    assert error is not None
    assert abs(value - 0.9875) < min(error, 1e-4)


def test_the_time_at_a_gap_has_what_the_run_has_strayed_by(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A gap e^-t that a run has 1 % late is 0.1 at 1.01 ln 10: 0.023 late, where splines are exact.

    The steps before and after are 0.0223 and 0.0248 late; without these the bar is a rounding.
    """
    body = '[[bodies]]\nname = "a"\nradius = 1.0\nposition = [0.0, 2.0]\n'
    steps = [f"{t},{math.exp(-t / 1.01)},{t / 101.0}" for t in np.arange(0.0, 5.0, 0.25)]

    def run(_: Case, folder: Path) -> None:
        folder.mkdir()
        (folder / "steps.csv").write_text("\n".join(["t,smallest_gap,err_t", *steps]) + "\n")

    monkeypatch.setattr("fsi.studies.evaluate.run", run)
    case = parse_case(tomllib.loads(ONE + body + "[time]\nend = 5.0\n"))
    found = of_motion(case, tmp_path / "run", ["time at gap 0.1"])["time at gap 0.1"]
    late = found.value - math.log(10.0)
    assert late == pytest.approx(0.01 * math.log(10.0), rel=1e-9)
    assert found.error is not None
    assert late < found.error < 0.03


@pytest.mark.parametrize("mass", [1e-6, 1e-4, 1e-2, 1.0])
def test_a_thrown_disc_dissipates_its_energy(mass: float, tmp_path: Path) -> None:
    """m/2 in a time of 1; by its dissipation before the film stops it it was 3.6 for a mass of 1e-6."""
    body = {"name": "a", "radius": 1.0, "position": [0.0, 1.001], "initial_velocity": [0.0, -1.0]}
    inertia = {"mass": mass, "moment_of_inertia": 0.5 * mass}
    data = tomllib.loads(ONE) | {"bodies": [body | inertia], "time": {"end": 1.0}}
    found = of_motion(parse_case(data), tmp_path / "run", ["dissipation"]).values["dissipation"]
    assert found.error is not None
    assert abs(found.value - 0.5 * mass) <= found.error < 1.5 * mass


def test_a_mass_that_is_held_has_nothing_to_lose(tmp_path: Path) -> None:
    """A disc along the plane at the speed t until 1: a third of the last. By that of its end the first step,
    1/16, has 2/3 16^-3 too much, 5e-4 of the mean."""
    rising = {"times": [0.0, 1.0], "values": [0.0, 1.0]}
    held = {"position": [0.0, 2.0], "velocity": [rising, 0.0], "angular_velocity": 0.0}
    inertia = {"mass": 1e-6, "moment_of_inertia": 5e-7}
    data = tomllib.loads(ONE) | {"bodies": [{"name": "a", "radius": 1.0} | held | inertia]}
    case = parse_case(data | {"time": {"end": 1.0}, "output": {"fields": False, "interval": 0.0625}})
    found = of_motion(case, tmp_path / "run", ["dissipation"]).values["dissipation"]
    last = float(rows(tmp_path / "run" / "steps.csv")[-1]["dissipation"])
    assert found.value == pytest.approx(last / 3.0, rel=1e-6)


def test_a_viscosity_that_is_no_number_for_an_instant_says_when(tmp_path: Path) -> None:
    """A lid goes to and fro, and rests at t = 0.5, on which a step lands."""
    lid = {"times": [0.0, 1.0], "values": [1.0, -1.0]}
    data = {
        "name": "to and fro", "model": "reduced", "fluid": {"viscosity": 1.0},
        "domain": {"lower": [0.0, 0.0], "upper": [6.0, 4.0], "periodic": ["x"], "walls": {"top": [lid, 0.0]}},
        "reduced": {"law": "exact", "shear_law": "exact", "rotation_law": "exact", "drag": 5.0, "cutoff": 1},
        "bodies": [{"name": "disc", "radius": 1.0, "position": [3.0, 1.5]}],
        "time": {"end": 1.0}, "output": {"fields": False, "interval": 0.125},
    }  # fmt: skip
    found = of_motion(parse_case(data), tmp_path / "run", ["apparent viscosity", "dissipation"])
    assert found["dissipation"].value > 0.0
    with pytest.raises(
        SolveError, match=r"no number at t = 0\.5, as with walls at rest; give another output\."
    ):
        found["apparent viscosity"]
