"""The four suspensions of cases/suspensions: one area fraction, one smallest gap, four arrangements."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from fsi.arrangements.arrangement import Arrangement
from fsi.arrangements.cell import SimulationCell
from fsi.case.body_file import read_bodies
from fsi.case.load import load_case
from fsi.integration.schemes import scheme_for
from fsi.models import make_model, make_stepper

FOLDER = Path(__file__).parents[1] / "cases" / "suspensions"
NAMES = ("rows", "random", "oblique_chains", "columns")


@pytest.mark.parametrize("name", NAMES)
def test_their_bodies(name: str) -> None:
    file = read_bodies(FOLDER / f"{name}.json")
    assert file.sides is not None
    centres = np.array([body["position"] for body in file.bodies])
    radii = np.array([body["radius"] for body in file.bodies])
    found = Arrangement(SimulationCell(file.sides, (True, False)), centres, radii)
    assert len(radii) == 40
    assert found.fraction() == pytest.approx(0.4, rel=1e-12)
    assert found.smallest_gap() >= 0.02 - 1e-12
    assert found.smallest_wall_gap() >= 0.02 - 1e-12


@pytest.mark.parametrize("name", NAMES)
def test_they_are_cases(name: str) -> None:
    assert len(load_case(FOLDER / f"{name}.toml").bodies) == 40


@pytest.mark.slow
def test_the_history_repeats_that_of_three_solves_a_step() -> None:
    """Its beginning, to what both meshes err by."""
    known = json.loads((Path(__file__).parent / "reference" / "suspension_history.json").read_text())
    viscosity = CubicSpline(known["strain"], known["apparent_viscosity"])
    case = load_case(FOLDER / "history.toml", ["time.end=0.1"])
    assert case.time is not None
    assert scheme_for(case.time.scheme, inertia=False).name == "adams"
    stepper = make_stepper(case, make_model(case))
    step = stepper.start(case.configuration())
    while step.state.t < 0.1:
        found = step.instant.record["apparent_viscosity"]
        assert found == pytest.approx(float(viscosity(step.state.t)), rel=1e-4)
        step = stepper.advance(step.state)


def test_the_history_is_a_case() -> None:
    case = load_case(FOLDER / "history.toml")
    assert case.time is not None
    assert (len(case.bodies), case.time.end) == (50, 3.0)
    assert np.pi * 50 / 19.816636**2 == pytest.approx(0.4, rel=1e-6)
