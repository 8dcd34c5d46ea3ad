"""Runs of the reduced model: files, resumption, comparison."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.case.law_file import LawFile, TableSection, save_law
from fsi.cli.main import main
from fsi.cli.solve import solve
from fsi.comparison.motion import History, RateComparison, compare_rates
from fsi.errors import InputError
from fsi.lubrication.named_laws import GapFilm, exact_law
from fsi.models import make_model
from fsi.postprocess.export import write_step_mesh
from fsi.postprocess.run.probe import probe
from fsi.postprocess.run.run import open_run
from fsi.run_folder.paraview import read_collection
from fsi.runs import resume
from fsi.runs import run as run_case
from tests.commands import fsi_command
from tests.exact_model import DiscsBesidePlane, by
from tests.ranks import python_on
from tests.reduced_data import INERTIA, heap, reduced_case
from tests.small_run import break_off, contents, rows

SCHEMES: dict[str, dict[str, object]] = {
    "adaptive": {},
    "distance": {"scheme": "distance", "step": 0.05},
    "backward-euler": {"scheme": "backward-euler", "step": 0.05, "law": "slides"},
}


def case_of(scheme: str) -> Case:
    reduced = {"law": "exact", "drag": 12.0, "cutoff": 0.5} | SCHEMES[scheme]
    if scheme == "backward-euler":
        del reduced["cutoff"]
    bodies = heap() if scheme == "adaptive" else heap(**INERTIA)
    return reduced_case(bodies, reduced, time={"end": 0.8, "tolerance": 1e-3}, output={"interval": 0.2})


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_resumed_run_is_the_unbroken_one_bit_by_bit(scheme: str, tmp_path: Path) -> None:
    case = case_of(scheme)
    outcome = run_case(case, tmp_path / "whole", make=by(make_model))
    break_off(tmp_path / "broken", case, outcome.state.step // 2, by(make_model))
    assert resume(tmp_path / "broken", make=by(make_model)).steps > 0
    assert contents(tmp_path / "broken") == contents(tmp_path / "whole")


def test_files_for_paraview_hold_bodies_and_contacts(tmp_path: Path) -> None:
    case = case_of("distance")
    run_case(case, tmp_path / "run", make=by(make_model))
    last = {name: read_collection(tmp_path / "run" / f"{name}.pvd")[-1] for name in ("bodies", "contacts")}
    assert {entry.t for entry in last.values()} == {0.8}
    bodies, contacts = (meshio.read(tmp_path / "run" / entry.file) for entry in last.values())
    table = rows(tmp_path / "run" / "bodies.csv")[-5:]
    assert bodies.points[:, :2].tolist() == [[float(row["x"]), float(row["y"])] for row in table]
    assert bodies.point_data["velocity"][:, 1].tolist() == [float(row["V_y"]) for row in table]
    assert bodies.point_data["radius"].tolist() == [body.radius for body in case.bodies]
    assert set(contacts.cell_data) == {"gap", "force", "gamma"}
    lengths = np.linalg.norm(np.diff(contacts.points[contacts.cells_dict["line"]], axis=1), axis=2)
    assert np.all(lengths > 0.5)
    steps = rows(tmp_path / "run" / "steps.csv")
    assert {"pairs", "power", "energy", "invariant", "drift", "log10_stored_gap"} <= set(steps[-1])
    assert max(float(step["invariant"]) for step in steps if step["invariant"]) < 1e-12


def test_the_end_of_a_run_tells_of_the_gaps_that_were_stored(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Those of the places are off by the drift, so that the least of them alone says little."""
    (tmp_path / "case.toml").write_text(case_of("distance").as_toml())
    assert fsi_command("run", tmp_path / "case.toml", "--output", tmp_path / "run") == 0
    steps = rows(tmp_path / "run" / "steps.csv")
    stored = 10.0 ** min(float(row["log10_stored_gap"]) for row in steps)
    drift = max(float(row["drift"]) for row in steps)
    assert drift > 0.01
    assert f"), stored {stored:.4g} (drift {drift:.3g}), " in capsys.readouterr().out


def test_the_comparison_of_a_model_with_itself_finds_no_difference() -> None:
    """Discs that feel only the plane, by the closed form, against the reduced model with that law."""
    cut = 2.0
    bodies = [{"name": "disc", "radius": 1.0, "position": [0.0, 1.5], "force": [0.0, -4.0]}]
    case = reduced_case(bodies, {"drag": 1.0, "cutoff": cut})
    exact = DiscsBesidePlane(case)
    drag = exact.resistance(Configuration.unturned(np.array([[0.0, 1.0 + cut]]), np.ones(1)))[0, 1]
    found = compare_with_exact(bodies, exact, float(drag))
    assert found.rate_error.max() < 1e-8  # of the table of the exact law
    assert found.good_below(0.01) == pytest.approx(0.5)
    assert found.bodies()[0]["velocity_difference"] < 1e-8
    assert found.bodies()[0]["gap_difference"] < 1e-12  # the same history


def test_a_drag_that_is_too_large_is_seen() -> None:
    """At a gap where the law is ten times the drag, ten per cent more drag costs a per cent."""
    bodies = [{"name": "disc", "radius": 1.0, "position": [0.0, 1.5], "force": [0.0, -4.0]}]
    case = reduced_case(bodies, {"drag": 1.0, "cutoff": 2.0})
    exact = DiscsBesidePlane(case)
    drag = float(exact.resistance(Configuration.unturned(np.array([[0.0, 3.0]]), np.ones(1)))[0, 1])
    found = compare_with_exact(bodies, exact, 1.5 * drag)
    gap = found.sample_gap
    R = exact.resistance(Configuration.unturned(np.column_stack([0.0 * gap, 1.0 + gap]), np.ones(len(gap))))[
        :, 1
    ]
    assert found.rate_error == pytest.approx(0.5 * drag / (R + 0.5 * drag), rel=1e-6)
    small = found.good_below(0.01)
    assert small is not None
    assert 1e-3 < small < 0.4


SHEARED = {"shape": "cell", "vectors": [[6.0, 0.0], [0.0, 5.0]], "shear": 1.0}
PAIR: list[dict[str, object]] = [
    {"name": "a", "radius": 1.0, "position": [1.0, 1.0]},
    {"name": "b", "radius": 1.0, "position": [2.4, 3.2]},
]
HELD: dict[str, object] = {"name": "held", "radius": 0.5, "position": [5.0, 0.6], "velocity": [0.0, 0.0]}


@pytest.mark.parametrize(
    ("bodies", "more"),
    [
        ([*heap(**INERTIA), HELD | INERTIA], {}),
        (PAIR, {"domain": SHEARED}),
    ],
)
def test_a_run_compared_with_itself(
    bodies: list[dict[str, object]], more: dict[str, object], tmp_path: Path
) -> None:
    """With inertia, which is a load on the fluid, and in a cell, whose images move: no difference.

    Gaps are those of steps.csv. They were those to the images of time 0, and inertia was left out.
    """
    reduced = {"drag": 12.0, "cutoff": 1.5}
    case = reduced_case(bodies, reduced, time={"end": 0.3, "tolerance": 1e-2}, **more)
    run_case(case, tmp_path / "run", make=by(make_model))
    run = open_run(tmp_path / "run")
    history = History.of_tables(case, run.columns("bodies"), run.columns("steps"))
    found = compare_rates(case, history, history)
    assert max(body["velocity_difference"] for body in found.bodies()) < 1e-6
    assert found.good_below(1e-6) == found.sample_gap.max()
    smallest = [float(step["smallest_gap"]) for step in rows(tmp_path / "run" / "steps.csv")]
    assert found.gap.min(axis=1) == pytest.approx(smallest, rel=1e-12)


def compare_with_exact(
    bodies: list[dict[str, object]], exact: DiscsBesidePlane, drag: float
) -> RateComparison:
    case = reduced_case(bodies, {"drag": drag, "cutoff": 2.0})
    t, centres = np.linspace(0.0, 1.0, 40), np.zeros((40, 1, 2))
    centres[:, 0, 1] = 1.0 + np.geomspace(0.5, 1e-3, 40)
    instants = [exact(Configuration.unturned(x, np.ones(1)), 0.0) for x in centres]
    U, F = (np.array([getattr(one, name) for one in instants]) for name in "UF")
    history = History(t, centres, U, F)
    return compare_rates(case, history, history)


def test_two_ranks_write_the_same_files(tmp_path: Path) -> None:
    """Every rank computes all, and root writes: bit by bit what one process writes."""
    case = case_of("adaptive")
    run_case(case, tmp_path / "one", make=by(make_model))
    (tmp_path / "case.toml").write_text(case.as_toml())
    command = [*python_on(2), "-m", "fsi", "run", "case.toml", "-o", "two"]
    root = Path(__file__).parents[2]
    subprocess.run(
        command, cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(root)}, check=True, capture_output=True
    )
    assert contents(tmp_path / "two") == contents(tmp_path / "one")


def test_commands_for_the_flow_name_those_that_work(tmp_path: Path) -> None:
    """A reduced run has no flow field, whatever output.fields says; those are not called here."""
    case = reduced_case(heap(), {"drag": 12.0}, time={"end": 0.01})
    run_case(case, tmp_path / "run", make=by(make_model))
    run = open_run(tmp_path / "run")
    with pytest.raises(InputError, match="has no flow field; use `fsi render`"):
        probe(run, np.zeros((1, 2)))
    with pytest.raises(InputError, match="has no flow field; use `fsi render`"):
        write_step_mesh(tmp_path / "run", 0, tmp_path / "mesh.vtu")


def test_solve_shows_an_instant(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Forces of the fluid on free bodies are minus their loads; the gap opens at lambda / kappa."""
    case = case_of("adaptive")
    (tmp_path / "case.toml").write_text(case.as_toml())
    solve(tmp_path / "case.toml", as_json=True)
    found = json.loads(capsys.readouterr().out)
    for body, given in zip(found["bodies"], heap(), strict=True):
        assert body["force"] == pytest.approx([-f for f in given["force"]])
    contact = next(row for row in found["contacts"] if row["between"] == ["b0", "plane"])
    law = exact_law(GapFilm("discs", 1.0, extrapolate=True))
    kappa = law.kappa(np.array([0.3, 0.5]), np.ones(2))
    assert contact["gap"] == pytest.approx(0.3)
    assert contact["force"] == pytest.approx((kappa[0] - kappa[1]) * contact["rate"])
    solve(tmp_path / "case.toml")
    assert "lubricated gaps" in capsys.readouterr().out


@pytest.mark.parametrize(("scheme", "gap"), [("adaptive", 0.3), ("distance", 0.3), ("adaptive", 0.01)])
def test_a_law_left_during_a_run_ends_it_in_one_line(
    scheme: str,
    gap: float,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A table from 0.02 to 0.2 radii, a disc that begins outside, or is pushed out of it."""
    table = TableSection(s=(0.02, 0.2), K=(400.0, 20.0))
    save_law(tmp_path / "law.toml", LawFile(form="table", shape="discs", viscosity=1.0, table=table))
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 1.1 if gap > 0.2 else 1.0 + gap]} | INERTIA
    body |= {"force": [0.0, 50.0]}
    if scheme == "adaptive":
        del body["mass"], body["moment_of_inertia"]
    reduced = {"law": str(tmp_path / "law.toml"), "drag": 12.0} | SCHEMES[scheme]
    case = reduced_case([body], reduced, time={"end": 5.0, "tolerance": 1e-3})
    (tmp_path / "case.toml").write_text(case.as_toml())
    arguments = ["run", str(tmp_path / "case.toml"), "-o", str(tmp_path / "run")]
    monkeypatch.setattr(sys, "argv", ["fsi", *arguments])
    monkeypatch.setattr(sys, "__stderr__", sys.stderr)
    assert main() == 3
    said = capsys.readouterr().err.strip().splitlines()
    assert len(said) == 1
    assert "the lubrication law holds from 0.02 to 0.2" in said[0]
    assert said[0].endswith("or ask for extrapolation with reduced.extrapolate = true")
