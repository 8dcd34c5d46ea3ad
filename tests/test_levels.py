"""One case at several levels: two discs or spheres on a line that are pushed together and pulled apart."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from fsi.case.case import MODELS, Case
from fsi.case.load import load_case, parse_case
from fsi.cli.main import app
from fsi.comparison.levels import case_at_levels, run_levels
from fsi.comparison.motion import History, trajectories
from fsi.errors import InputError
from fsi.levels import LEVELS, VISCOUS
from fsi.models import EVOLUTIONS, INSTANTS, make_evolution
from fsi.postprocess.run.run import open_run
from fsi.runs import run
from fsi.studies.evaluate import at_instant
from tests.commands import fsi_command

ROOT = Path(__file__).parents[1]
PUSH = {"times": [0.0, 2.0, 2.0], "values": [1.0, 1.0, -1.0]}
PULL = {"times": [0.0, 2.0, 2.0], "values": [-1.0, -1.0, 1.0]}


def pair(model: str, **more: Any) -> dict[str, Any]:
    """Two discs of mass 1 at gap 1; pushed by 1 until t = 2 they meet at t = 1, pulled they part at t = 4."""
    bodies = [
        {
            "name": name,
            "radius": 1.0,
            "mass": 1.0,
            "moment_of_inertia": 0.5,
            "position": [x, 0.0],
            "velocity": ["free", 0.0],
            "angular_velocity": 0.0,
            "force": [force, 0.0],
        }
        for name, x, force in (("first", -1.5, PUSH), ("second", 1.5, PULL))
    ]
    data = {
        "name": "pair",
        "model": model,
        "domain": {"lower": [-50.0, -50.0], "upper": [50.0, 50.0]},
        "bodies": bodies,
        "time": {"end": 6.0, "step": 0.01},
        "output": {"fields": False, "interval": 0.05},
    }
    return data | more


@pytest.mark.parametrize("model", ["gluey", pytest.param("macroscopic", marks=pytest.mark.slow)])
def test_a_pair_on_a_line_is_the_closed_form_at_both_levels_without_fluid(model: str, tmp_path: Path) -> None:
    """gap 1 - t^2 until 1, 0 until 4, then (t - 4)^2; the push of 2 is paid back by a pull of 2."""
    run(parse_case(pair(model)), tmp_path / "run")
    bodies = open_run(tmp_path / "run").bodies
    t, x = bodies["t"].to_numpy()[::2], bodies["x"].to_numpy().reshape(-1, 2)
    gap = np.diff(x)[:, 0] - 2.0
    exact = np.where(t < 1.0, 1.0 - t**2, np.where(t < 4.0, 0.0, (t - 4.0) ** 2))
    # of first order: with steps of 0.01 the places are off by up to h times the largest speed, 4
    np.testing.assert_allclose(gap, exact, atol=0.04)
    assert np.abs(gap[(t > 1.01) & (t < 3.99)]).max() < 1e-9
    # what is held does not move, and no momentum is made
    assert not bodies["y"].any()
    np.testing.assert_allclose(bodies["V_x"].to_numpy().reshape(-1, 2).sum(axis=1), 0.0, atol=1e-10)


def test_gluey_and_macroscopic_bodies_agree_where_their_masses_differ(tmp_path: Path) -> None:
    """Three spheres on an axis, one of twice the size: the same places at both levels, to the rounding."""
    sizes = ((0.5, 0.0, 1.0), (1.0, 2.5, 0.0), (0.5, 5.0, -2.0))
    bodies = [
        {"name": f"s{k}", "radius": a, "mass": a, "position": [0.0, z], "initial_velocity": [0.0, U]}
        for k, (a, z, U) in enumerate(sizes)
    ]
    data = {
        "name": "three",
        "geometry": "axisymmetric",
        "domain": {"shape": "unbounded"},
        "bodies": bodies,
        "macroscopic": {"parcels": 40},
        "time": {"end": 3.0, "step": 0.02},
        "output": {"fields": False},
    }
    places = []
    for model in ("gluey", "macroscopic"):
        run(parse_case(data | {"model": model}), tmp_path / model)
        places.append(open_run(tmp_path / model).bodies["y"].to_numpy())
    np.testing.assert_allclose(places[0], places[1], atol=1e-9)
    # all three have met and go on together with the momentum 0.5 - 1 over the mass 2
    V = open_run(tmp_path / "gluey").bodies["V_y"].to_numpy()[-3:]
    np.testing.assert_allclose(V, -0.25, atol=1e-12)


def test_a_gluey_body_that_moves_as_prescribed_pushes_a_free_one(tmp_path: Path) -> None:
    """A piston at the velocity t/2 meets a disc at gap 1/4 when t = 1, and takes it along from then on."""
    ramp = {"times": [0.0, 4.0], "values": [0.0, 2.0]}
    still = {"radius": 1.0, "mass": 1.0, "moment_of_inertia": 0.5, "angular_velocity": 0.0}
    bodies = [
        still | {"name": "piston", "position": [0.0, 0.0], "velocity": [ramp, 0.0]},
        still | {"name": "free", "position": [2.25, 0.0], "velocity": ["free", 0.0]},
    ]
    case = parse_case(pair("gluey", bodies=bodies, time={"end": 2.0, "step": 0.01}))
    run(case, tmp_path / "run")
    bodies_of_run = open_run(tmp_path / "run").bodies
    t, x = bodies_of_run["t"].to_numpy()[::2], bodies_of_run["x"].to_numpy().reshape(-1, 2)
    np.testing.assert_allclose(x[:, 0], t**2 / 4.0, atol=1e-12)  # a linear velocity is integrated exactly
    np.testing.assert_allclose(x[t >= 1.05, 1] - x[t >= 1.05, 0], 2.0, atol=1e-9)
    assert np.all(x[t <= 1.0, 1] == 2.25)


def test_forces_between_gluey_bodies_act_over_the_gap(tmp_path: Path) -> None:
    """A repulsion that is 3 everywhere drives two unit masses apart: gap 1 + 3 t^2, of first order."""
    force = {"kind": "repulsion", "law": "table", "gaps": [0.0, 40.0], "values": [3.0, 3.0]}
    free = [body | {"force": [0.0, 0.0]} for body in pair("gluey")["bodies"]]
    case = parse_case(pair("gluey", bodies=free, forces=[force], time={"end": 1.0, "step": 5e-3}))
    run(case, tmp_path / "run")
    x = open_run(tmp_path / "run").bodies["x"].to_numpy()[-2:]
    assert x[1] - x[0] - 2.0 == pytest.approx(4.0, abs=1.6e-2)  # 3 h t of an explicit step


@pytest.mark.slow
def test_what_stands_for_infinity_ends_a_gluey_run_that_gets_there(tmp_path: Path) -> None:
    body = pair("gluey")["bodies"][0] | {"force": [1.0, 0.0], "velocity": ["free", "free"]}
    domain = {"shape": "half-plane", "radius": 4.0}
    body["position"] = [0.0, 1.5]
    case = parse_case(pair("gluey", bodies=[body], domain=domain))
    with pytest.raises(Exception, match=r"domain\.radius: body first has come to the far end"):
        run(case, tmp_path / "run")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"bodies": []}, "macroscopic.blocks: missing"),
        ({"macroscopic": {"parcels": 5}}, "macroscopic.parcels = 5: the diameters of the bodies"),
        ({"forces": [{"kind": "gravity", "acceleration": [0.0, -1.0]}]}, "forces.0"),
        ({"time": {"end": 1.0}}, "time.step: missing"),
    ],
)
def test_mistakes_of_a_line_of_bodies_are_one_line(change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse_case(pair("macroscopic") | change)


def test_bodies_off_a_line_are_refused_by_name() -> None:
    data = pair("macroscopic")
    data["bodies"][1]["position"] = [1.5, 0.5]
    with pytest.raises(InputError, match=r"bodies\.1\.position = \[1\.5, 0\.5\]: not on a line"):
        parse_case(data)
    data = pair("macroscopic")
    data["bodies"][1]["mass"] = 3.0
    with pytest.raises(InputError, match=r"bodies\.1\.mass = 3: matter has one density"):
        parse_case(data)


def test_any_levels_are_compared(tmp_path: Path) -> None:
    """The shipped case at its three cheap levels: as good as the fluid's viscosity is small."""
    levels = ["--levels", "reduced,gluey,macroscopic"]
    command = [
        "compare",
        str(ROOT / "cases" / "levels.toml"),
        *levels,
        "-o",
        str(tmp_path / "levels"),
        "--json",
    ]
    done = CliRunner().invoke(app, [*command, "--set", "time.end=5", "--set", "time.step=0.02"])
    assert done.exit_code == 0, done.output
    data = json.loads(done.stdout.splitlines()[-1])
    assert data["levels"] == ["reduced", "gluey", "macroscopic"]
    assert data["differences"]["reduced"] == 0.0
    assert 0.01 < data["differences"]["gluey"] < 0.15  # the slides' limit, at eps = 0.003 over the impulse 2
    gaps = np.array(data["gaps"]["gluey"])
    np.testing.assert_allclose(data["gaps"]["macroscopic"], gaps, atol=1e-9)
    assert (tmp_path / "levels" / "comparison.png").stat().st_size > 10_000


def test_what_is_compared_does_not_depend_on_the_times_of_output(tmp_path: Path) -> None:
    """A pair meets at t = 1, its gap is 1 - t^2 before and 0 after, in steps of 0.02 off by 0.02 at most.

    On the line between the rows of a gluey run at t = 0 and 1.5, 1 - t/1.5, it was 1/3 at t = 1.
    """
    output, time = {"fields": False, "interval": 1.5}, {"end": 1.5, "step": 0.02}
    case = parse_case(pair("gluey", output=output, time=time, macroscopic={"parcels": 40}))
    cases = case_at_levels(case, ["macroscopic", "gluey"])
    run_levels(cases, tmp_path)
    runs = {level: open_run(tmp_path / level) for level in cases}
    histories = {
        level: History.of_tables(cases[level], each.columns("bodies"), each.columns("steps"))
        for level, each in runs.items()
    }
    found = trajectories(cases, histories)
    assert found.differences["gluey"] < 1e-9
    exact = np.maximum(0.0, 1.0 - found.t**2)
    np.testing.assert_allclose(found.smallest["gluey"], exact, atol=0.021)
    assert len(runs["gluey"].bodies) == 2 * len(runs["gluey"].steps)


def test_levels_with_a_flow_write_fields_as_the_case_says() -> None:
    """Each of them is large, and their rows are of all steps."""
    case = load_case(ROOT / "cases" / "compare_settling.toml")
    found = case_at_levels(case, ["resolved", "reduced"])
    assert [each.output.interval for each in found.values()] == [4.0, None]


@pytest.mark.parametrize("levels", [["gluey"], ["gluey", "gluey"], ["gluey", "sticky"]])
def test_levels_that_are_none_are_refused(levels: list[str]) -> None:
    with pytest.raises(InputError, match="--levels"):
        case_at_levels(parse_case(pair("gluey")), levels)


def test_only_levels_with_a_fluid_want_one_and_refuse_jumps() -> None:
    with pytest.raises(InputError, match="fluid: missing"):
        parse_case(pair("resolved"))
    with pytest.raises(InputError, match=r"bodies\.0\.force\.0: jumps at t = 2"):
        parse_case(pair("resolved", fluid={"viscosity": 1.0}))
    assert make_evolution(parse_case(pair("gluey"))).schedule.end == 6.0


def test_what_steps_a_level_is_as_the_level_says() -> None:
    assert tuple(LEVELS) == MODELS
    assert tuple(INSTANTS) == VISCOUS
    assert {*INSTANTS, *EVOLUTIONS} == {*MODELS}


class Carrying:
    """A level without a flow: bodies move at U = 7 F, and gaps have no laws."""

    def __init__(self, case: Case) -> None:
        self.F = case.motion(0.0).F

    def __call__(self, *_: object) -> Any:
        return SimpleNamespace(U=7.0 * self.F, F=self.F, record={"power": 0.0}, dissipation=14.0)


def test_a_level_without_a_flow_is_solved_by_what_it_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The registry decides: the network of gaps stood in for all of them, here with U below 1/10."""
    push = [body | {"force": [1.0, 0.0]} for body in pair("reduced")["bodies"]]
    case = parse_case(pair("reduced", bodies=push, fluid={"viscosity": 1.0}, reduced={"drag": 10.0}))
    monkeypatch.setitem(INSTANTS, "reduced", Carrying)
    assert at_instant(case, ["first.velocity.x"]).values["first.velocity.x"].value == 7.0
    (tmp_path / "case.toml").write_text(case.as_toml())
    assert fsi_command("solve", tmp_path / "case.toml", "--json") == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["bodies"][0]["velocity"][0], data["contacts"]) == (7.0, [])
    assert fsi_command("solve", tmp_path / "case.toml") == 0
    assert "gap" not in capsys.readouterr().out
