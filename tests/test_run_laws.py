"""Runs with laws below a gap in sheared cells, across a change of the lattice's basis."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.bodies.configuration import PLACES
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.models import make_evolution
from fsi.postprocess.run.run import Run, open_run
from fsi.runs import resume, run
from fsi.stokes.model import StokesModel
from tests.commands import fsi_command
from tests.ranks import python_on
from tests.small_run import break_off, contents, rows

# The last vector leans by half of the first at t = 0.02, from when on the difference of both is shorter.
SPACE = {
    "geometry": "spatial",
    "domain": {"shape": "cell", "vectors": [[3.6, 0, 0], [0.3, 3.6, 0], [1.728, 0.5, 3.6]], "shear": 1.0},
    "bodies": [
        {"name": "a", "radius": 1.0, "position": [0.3, 0.2, 0.1]},
        {"name": "b", "radius": 0.9, "position": [0.3 + 1.93 * 0.6, 0.2, 0.1 + 1.93 * 0.8]},
    ],
    "discretisation": {"degree": 2, "cells_per_gap": 0.5, "cells_per_circle": 8, "growth": 1.0},
    "time": {"end": 0.025, "first_step": 0.01, "tolerance": 0.03},
}
PLANE = {
    "domain": {"shape": "cell", "vectors": [[4.0, 0.0], [1.92, 3.8]], "shear": 1.0},
    "bodies": [
        {"name": "a", "radius": 1.0, "position": [0.3, 0.2]},
        {"name": "b", "radius": 0.9, "position": [0.3 + 1.93 * 0.6, 0.2 + 1.93 * 0.8]},
    ],
    "discretisation": {"cells_per_circle": 16},
    "time": {"end": 0.04, "first_step": 0.01, "tolerance": 0.01},
}


def case_of(data: dict[str, Any], remesh: str, **time: float) -> Case:
    shared = {"name": "laws", "fluid": {"viscosity": 0.7}, "lubrication": {"below": 0.09}}
    more = {"time": data["time"] | {"remesh": remesh} | time, "output": {"fields": False}}
    return parse_case(data | shared | more)


def require_another_basis(done: Run) -> None:
    """The lattice has another basis at the end: its vectors jump by more than the flow moves them."""
    first, last = (done.case.container().at(t).periods for t in (0.0, done.end))
    assert np.abs(last - first).max() > 1.0


@pytest.mark.parametrize("data", [PLANE, pytest.param(SPACE, marks=pytest.mark.slow)], ids=["plane", "space"])
def test_a_resumed_run_repeats_the_unbroken_one(data: dict[str, Any], tmp_path: Path) -> None:
    """Bit by bit, on a mesh that is moved."""
    case, whole, broken = case_of(data, "when-needed"), tmp_path / "whole", tmp_path / "broken"
    run(case, whole)
    break_off(broken, case, 1, make_evolution)
    assert resume(broken).steps > 0
    assert contents(broken) == contents(whole)
    require_another_basis(open_run(whole))


@pytest.mark.parametrize(
    ("data", "remesh", "mesh_error"),
    [
        pytest.param(PLANE, "always", 1e-10, id="plane"),
        pytest.param(PLANE, "when-needed", 2e-5, id="plane, moved mesh"),
        pytest.param(SPACE, "always", 1e-8, id="space", marks=pytest.mark.slow),
    ],
)
def test_each_instant_of_a_run_is_that_of_its_bodies_solved_anew(
    data: dict[str, Any], remesh: str, mesh_error: float, tmp_path: Path
) -> None:
    """A mesh that is moved by what bodies move, not by what their places in it do, is 4e-3 off."""
    case = case_of(data, remesh, first_step=0.025)
    run(case, tmp_path / "run")
    done, anew, d = open_run(tmp_path / "run"), StokesModel(case_of(data, "always")), case.dimension
    require_another_basis(done)
    for step in done.steps["step"].astype(int):
        q, t = done.configuration(step), done.time(step)
        found, rows = anew(q, t), done.bodies[done.bodies["step"] == step]
        V = rows[[f"V_{c}" for c in "xyz"[:d]]].to_numpy()
        S = rows[[f"S_{c}" for c in ("xx", "xy", "yy", "xz", "yz", "zz")[: 3 * d - 3]]].to_numpy()
        assert found.bulk is not None
        assert found.apparent_viscosity is not None
        places = ([0, 0, 1, 0, 1, 2][: 3 * d - 3], [0, 1, 1, 2, 2, 2][: 3 * d - 3])
        wanted = found.bulk.stresslets[(slice(None), *places)]
        row = done.steps[done.steps["step"] == step].iloc[0]
        np.testing.assert_allclose(V, found.U[:, :d], atol=mesh_error)
        np.testing.assert_allclose(S, wanted, atol=mesh_error * np.abs(wanted).max())
        np.testing.assert_allclose(row["apparent_viscosity"], found.apparent_viscosity, rtol=mesh_error)


@pytest.mark.parametrize(("x", "shut_in"), [(1.01, "1"), (1.2, "0")])
def test_a_run_says_that_fluid_is_shut_in(
    x: float, shut_in: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A disc in a corner, both its gaps, or one, below that of laws: a column, and a line at the end."""
    data = {
        "name": "corner",
        "fluid": {"viscosity": 1.0},
        "domain": {"lower": [0.0, 0.0], "upper": [4.0, 4.0]},
        "bodies": [{"name": "disc", "radius": 1.0, "position": [x, 1.01], "force": [0.0, -1e-3]}],
        "discretisation": {"cells_per_circle": 16},
        "lubrication": {"below": 0.05},
        "time": {"end": 0.01, "first_step": 0.01},
        "output": {"fields": False},
    }
    (tmp_path / "corner.toml").write_text(parse_case(data).as_toml())
    assert fsi_command("run", tmp_path / "corner.toml", "--output", tmp_path / "run") == 0
    told = "note: from t = 0 gaps below lubrication.below shut fluid in, whose pressure no law knows:"
    assert (told in capsys.readouterr().out) == (shut_in == "1")
    assert {row["shut_in"] for row in rows(tmp_path / "run" / "steps.csv")} == {shut_in}


@pytest.mark.mpi
@pytest.mark.slow
@pytest.mark.parametrize("data", [PLANE, SPACE], ids=["plane", "space"])
def test_ranks_take_the_same_way(data: dict[str, Any], tmp_path: Path) -> None:
    """On a mesh that is moved, so that none is made of other last digits."""
    (tmp_path / "case.toml").write_text(case_of(data, "when-needed").as_toml())
    serial, *others = (_run_on(ranks, tmp_path) for ranks in (1, 2, 3))
    places = [*PLACES[serial.case.dimension], "V_x", "V_y"]
    for other in others:
        assert other.steps["cells"].nunique() == 1
        for column in ("t", "smallest_gap", "apparent_viscosity", "law_dissipation", "N_1"):
            np.testing.assert_allclose(other.steps[column], serial.steps[column], rtol=1e-9, atol=1e-10)
        np.testing.assert_allclose(other.bodies[places], serial.bodies[places], rtol=0, atol=1e-9)


def _run_on(ranks: int, folder: Path) -> Run:
    output = folder / str(ranks)
    command = [*python_on(ranks), "-m", "fsi", "run", str(folder / "case.toml"), "-q", "-o", str(output)]
    subprocess.run(command, check=True, timeout=900)
    return open_run(output)
