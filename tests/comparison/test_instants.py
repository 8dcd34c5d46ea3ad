"""The levels of a case at time 0: the errors by hand, and the table that the command prints."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from fsi.case.case import Case
from fsi.case.load import load_case
from fsi.cli.main import app
from fsi.comparison.instants import compare_instants, instants_json
from fsi.comparison.levels import case_at_levels
from fsi.errors import InputError, SolveError
from fsi.models import make_model
from tests.reduced_data import reduced_case

CASES = Path(__file__).parents[2] / "cases"
CHANNEL = {
    "lower": [0.0, 0.0],
    "upper": [6.0, 6.0],
    "periodic": ["x"],
    "walls": {"bottom": [-1.0, 0.0], "top": [3.0, 0.0]},
}
LAWS = {"law": "exact", "shear_law": "exact", "rotation_law": "exact", "cutoff": 1.0}


def three_discs(drag: float) -> Case:
    """Two near each other and one near the top; four gaps are below the reach of two radii."""
    places = [[1.0, 2.0], [3.1, 2.3], [4.5, 4.9]]
    bodies = [{"name": f"b{k}", "radius": 1.0, "position": x} for k, x in enumerate(places)]
    return reduced_case(bodies, LAWS | {"drag": drag}, domain=CHANNEL)


def test_the_errors_are_those_of_their_definitions() -> None:
    """Two drags for two levels: u_inf = -1 + 2/3 y, the three narrowest of the gaps by hand."""
    cases = {"first": three_discs(5.0), "second": three_discs(50.0)}
    found = compare_instants(cases)
    one, other = (make_model(case)(case.configuration(), 0.0) for case in cases.values())
    x = cases["first"].configuration().centres
    mean = np.column_stack([-1.0 + 2.0 / 3.0 * x[:, 1], np.zeros(3)])
    row, norm = found["second"], np.linalg.norm
    off = other.U - one.U
    assert row.velocities == pytest.approx(norm(off[:, :2]) / norm(one.U[:, :2] - mean))
    assert row.spins == pytest.approx(norm(off[:, 2]) / norm(one.U[:, 2]))
    mu = [instant.record["apparent_viscosity"] for instant in (one, other)]
    assert row.viscosity == pytest.approx(mu[1] / mu[0] - 1.0)
    assert (found["first"].viscosity, found["first"].velocities, found["first"].gap_rates) == (0.0, 0.0, 0.0)

    def rates(U: np.ndarray) -> np.ndarray:
        """Of the discs 0 and 1, of 2 and the top, of 1 and 2: gaps of 0.12, 0.1 and 0.95."""
        first, second = (x[1] - x[0]) / norm(x[1] - x[0]), (x[2] - x[1]) / norm(x[2] - x[1])
        return np.array([first @ (U[1] - U[0])[:2], -U[2, 1], second @ (U[2] - U[1])[:2]])

    assert row.gap_rates == pytest.approx(norm(rates(off)) / norm(rates(one.U)))


def test_a_viscosity_that_is_no_number_compares_with_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither that of a level, nor that of the first: JSON knows no NaN."""

    def at(case: Case) -> Callable[..., SimpleNamespace]:
        mu = float("nan") if case.drag == 5.0 else 1.5
        U = np.ones((3, 3))
        return lambda *_: SimpleNamespace(U=U, record={"apparent_viscosity": mu})

    monkeypatch.setattr("fsi.comparison.instants.make_model", at)
    known, unknown = three_discs(50.0), three_discs(5.0)
    for cases in ({"a": known, "b": unknown}, {"a": unknown, "b": known}):
        found = compare_instants(cases)
        assert found["b"].viscosity is None
        json.dumps(instants_json(found), allow_nan=False)


def test_what_symmetry_makes_zero_has_no_relative_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Spins of 1e-5 of the speeds are the solve's; those of 1e-2 are compared: 0 is 100 % off."""

    def at(case: Case) -> Callable[..., SimpleNamespace]:
        U = np.array([[2.0, 1.0, 0.0], [2.0, -1.0, spin if case.drag == 5.0 else 0.0], [1.0, 0.0, 0.0]])
        return lambda *_: SimpleNamespace(U=U, record={})

    monkeypatch.setattr("fsi.comparison.instants.make_model", at)
    spin = 1e-5
    assert compare_instants({"a": three_discs(5.0), "b": three_discs(50.0)})["b"].spins is None
    spin = 1e-2
    assert compare_instants({"a": three_discs(5.0), "b": three_discs(50.0)})["b"].spins == 1.0


def test_a_case_without_time_is_compared_at_its_instant(tmp_path: Path) -> None:
    """Resolved and reduced: what is printed is what the file holds, and no picture is made."""
    path, folder = tmp_path / "case.toml", tmp_path / "out"
    path.write_text(three_discs(8.0).model_copy(update={"time": None}).as_toml())
    result = CliRunner().invoke(app, ["compare", str(path), "-o", str(folder)])
    assert result.exit_code == 0, result.output
    rows = json.loads((folder / "comparison.json").read_text())["instant"]
    assert set(rows) == {"resolved", "reduced"}
    assert {file.name for file in folder.iterdir()} == {"comparison.json"}
    assert f"{100.0 * rows['reduced']['viscosity']:+.3g}" in result.output
    assert f"{100.0 * rows['reduced']['velocities']:.3g}" in result.output
    # two models of one flow: far from equal, and of the same size
    assert 0.01 < abs(rows["reduced"]["viscosity"]) < 0.5


def test_a_level_that_only_steps_needs_a_time(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(load_case(CASES / "levels.toml").model_copy(update={"time": None}).as_toml())
    levels = ["--levels", "reduced,gluey", "-o", str(tmp_path / "out")]
    result = CliRunner().invoke(app, ["compare", str(path), *levels])
    assert isinstance(result.exception, InputError)
    assert "time: missing" in str(result.exception)
    assert not (tmp_path / "out").exists()


def test_networks_that_inertia_alone_determines_have_no_instant() -> None:
    """The example of `fsi compare --help`, which has masses and no drag, was refused for want of drag."""
    case = load_case(CASES / "levels.toml")
    assert compare_instants(case_at_levels(case, ["resolved", "reduced", "gluey", "macroscopic"])) == {}
    (reduced,) = [each for each in case_at_levels(case, ["reduced", "gluey"]).values() if each.level.viscous]
    with pytest.raises(SolveError, match="give it drag, or in a run a mass"):
        make_model(reduced)(reduced.configuration(), 0.0)


PLACES = {"a": [1.0, 2.0], "b": [3.2, 2.6]}
DRIVEN = {"cell": ("shear_rate", 0.0), "box": ("speed_top", -1.0)}
STRESSED = [
    {"shape": "cell", "vectors": [[6.0, 0.0], [0.0, 6.0]], "stress": 2.0},
    CHANNEL | {"walls": {"bottom": [-1.0, 0.0], "top": {"stress": 2.0}}},
]


@pytest.mark.parametrize("domain", STRESSED)
def test_levels_under_a_stress_have_the_mean_flows_that_they_find(domain: dict[str, object]) -> None:
    """Rates of shear are as 1 / mu; pores with eight modes are off by 4e-5 of the resolved flow and less.

    With the lattice or the wall at rest rates of gaps would be other ones altogether.
    """
    bodies = [{"name": name, "radius": 1.0, "position": x} for name, x in PLACES.items()]
    case = reduced_case(bodies, {}, domain=domain, model="pores", pores={"modes": 8})
    cases = case_at_levels(case, ["resolved", "pores"])
    found, (column, still) = compare_instants(cases)["pores"], DRIVEN[str(domain.get("shape", "box"))]
    rates = [make_model(each)(each.configuration(), 0.0).record[column] - still for each in cases.values()]
    assert found.viscosity == pytest.approx(rates[0] / rates[1] - 1.0, abs=1e-9)
    assert [found.velocities, found.spins, found.gap_rates] == pytest.approx([0.0] * 3, abs=1e-4)


def test_images_move_with_the_lattice_that_a_stress_shears() -> None:
    """One disc nears its image at 3.5 e_y + 1.5 e_x at a rate in proportion to that of the shear."""
    cell = {"shape": "cell", "vectors": [[6.0, 0.0], [1.5, 3.5]], "stress": 2.0}
    body = {"name": "b", "radius": 1.0, "position": [1.0, 2.0]}
    case = reduced_case([body], {}, domain=cell, model="pores", pores={"modes": 1})
    cases = case_at_levels(case, ["resolved", "pores"])
    rate = [make_model(each)(each.configuration(), 0.0).record["shear_rate"] for each in cases.values()]
    assert compare_instants(cases)["pores"].gap_rates == pytest.approx(abs(rate[1] / rate[0] - 1.0), rel=1e-9)
