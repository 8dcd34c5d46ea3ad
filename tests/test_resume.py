from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from fsi.errors import InputError, SolveError
from fsi.runs import resume
from tests.exact_model import by
from tests.ranks import python_on
from tests.small_run import break_off, contents, launches, made_older, make_model, rows, small_case, start


def test_resuming_a_finished_run_changes_nothing(unbroken: Path) -> None:
    before = contents(unbroken)
    assert resume(unbroken, make=by(make_model)).steps == 0
    assert contents(unbroken) == before
    assert len(launches(unbroken)) == 1


def test_what_comes_after_the_last_commit_is_cut_off(unbroken: Path, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    break_off(folder, small_case(), step=4)
    with (folder / "steps.csv").open("a") as table:
        table.write("5,0.5")
    (folder / "fields" / "fluid_000099_0.vtu").write_text("half a fi")
    (folder / "fields" / ".partial-1-fluid_000005_0.vtu").write_text("half a fi")
    (folder / "state.npz.tmp").write_text("half a st")
    (folder / "fluid.pvd").write_bytes((unbroken / "fluid.pvd").read_bytes())
    (folder / "notes.txt").write_text("the user's own")
    assert resume(folder, make=by(make_model)).steps > 0
    (folder / "notes.txt").unlink()
    assert contents(folder) == contents(unbroken)
    assert len(launches(folder)) == 2


@pytest.mark.parametrize("step", [1, 2, 7])
def test_a_scheme_of_several_steps_goes_on_as_if_it_had_not_been_broken_off(
    step: int, tmp_path: Path
) -> None:
    adams = small_case(time={"end": 1.0, "tolerance": 1e-6, "first_step": 0.5, "scheme": "adams"})
    start(adams, tmp_path / "unbroken")
    break_off(tmp_path / "run", adams, step)
    assert resume(tmp_path / "run", make=by(make_model)).steps > 0
    assert contents(tmp_path / "run") == contents(tmp_path / "unbroken")


def test_a_run_of_an_older_version_goes_on(unbroken: Path, tmp_path: Path) -> None:
    """Its state has no strain, no checksums and no case; in the end it has those of an unbroken run."""
    folder = tmp_path / "run"
    break_off(folder, small_case(), step=4)
    made_older(folder)
    assert resume(folder, make=by(make_model)).steps > 0
    assert contents(folder) == contents(unbroken)


def test_lost_rows_are_noticed(tmp_path: Path) -> None:
    break_off(tmp_path / "run", small_case(), step=4)
    (tmp_path / "run" / "bodies.csv").write_text("step\n")
    with pytest.raises(InputError, match=r"bodies\.csv has lost rows"):
        resume(tmp_path / "run", make=by(make_model))


@pytest.mark.parametrize("written", [{}, {"format": 2}, {"format": 4}])
def test_a_run_of_another_version_is_refused_in_one_line(written: dict[str, int], tmp_path: Path) -> None:
    """Before the format had a number, case files had other keys."""
    break_off(tmp_path / "run", small_case(), step=4)
    provenance = tmp_path / "run" / "provenance.json"
    data = {key: value for key, value in json.loads(provenance.read_text()).items() if key != "format"}
    provenance.write_text(json.dumps(data | written))
    before = contents(tmp_path / "run")
    with pytest.raises(InputError, match=r"a run of another version of this program .*; run the case again"):
        resume(tmp_path / "run", make=by(make_model))
    assert contents(tmp_path / "run") == before


def test_a_damaged_state_is_one_line(tmp_path: Path) -> None:
    break_off(tmp_path / "run", small_case(), step=4)
    (tmp_path / "run" / "state.npz").write_bytes(b"PK\x03\x04 nothing")
    with pytest.raises(InputError, match=r"output = .*run"):
        resume(tmp_path / "run", make=by(make_model))


def test_a_blocked_run_keeps_its_last_good_state(tmp_path: Path) -> None:
    driven = {"name": "disc", "radius": 1.0, "position": [0.0, 2.0], "velocity": [0.0, -1.0]}
    case = small_case(bodies=[driven], time={"end": 2.0, "smallest_step": 1e-3})
    with pytest.raises(SolveError, match=r"wall plane"):
        start(case, tmp_path / "run")
    before = contents(tmp_path / "run")
    assert float(rows(tmp_path / "run" / "steps.csv")[-1]["t"]) > 0.99
    with pytest.raises(SolveError, match=r"wall plane"):
        resume(tmp_path / "run", make=by(make_model))
    assert contents(tmp_path / "run") == before


@pytest.mark.mpi
def test_three_ranks_write_what_one_writes(unbroken: Path, tmp_path: Path) -> None:
    """The model is the same on all ranks here; what is tested is that root alone writes."""
    program = f"from tests.small_run import *; start(small_case(), Path({str(tmp_path / 'run')!r}))"
    subprocess.run([*python_on(3), "-c", program], check=True, timeout=900)
    assert contents(tmp_path / "run") == contents(unbroken)
    assert launches(tmp_path / "run")[0]["ranks"] == 3
