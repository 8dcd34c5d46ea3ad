from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.case.case import Case
from fsi.errors import InputError, SolveError
from fsi.integration.state import StepRecord
from fsi.run_folder.alone import locked
from fsi.runs import resume, run
from tests.exact_model import by
from tests.ranks import needs_mpi, python_on
from tests.small_run import contents, launches, make_model, rows, small_case, start


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "unbroken"
    start(small_case(), folder)
    return folder


def test_resuming_a_finished_run_changes_nothing(unbroken: Path) -> None:
    before = contents(unbroken)
    assert resume(unbroken, make=by(make_model)).steps == 0
    assert contents(unbroken) == before
    assert len(launches(unbroken)) == 1


class KilledError(Exception):
    """Instead of a signal, where the place to break off is a step."""


def break_off(folder: Path, case: Case, step: int) -> None:
    def progress(record: StepRecord) -> None:
        if record.step == step:
            raise KilledError

    with pytest.raises(KilledError):
        run(case, folder, progress, make=by(make_model))


def test_what_comes_after_the_last_commit_is_cut_off(unbroken: Path, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    break_off(folder, small_case(), step=4)
    with (folder / "steps.csv").open("a") as table:
        table.write("5,0.5")
    (folder / "fields" / "fluid_000099_0.vtu").write_text("half a fi")
    (folder / "fields" / ".fluid_000005_0.vtu.partial").write_text("half a fi")
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


def test_a_run_from_before_cells_were_sheared_by_a_stress_goes_on(unbroken: Path, tmp_path: Path) -> None:
    """Its state has no strain."""
    folder = tmp_path / "run"
    break_off(folder, small_case(), step=4)
    with np.load(folder / "state.npz") as state:
        arrays = {name: state[name] for name in state.files if name != "strain"}
    np.savez(folder / "state.npz", **arrays)
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


def fork(action: Callable[[], object]) -> int:
    """Run in a child process; its number."""
    child = os.fork()
    if child == 0:
        code = 1
        try:
            action()
            code = 0
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stderr.flush()
            os._exit(code)
    return child


def in_child(action: Callable[[], object], kill_at: int = 0) -> int:
    """Run in a child that ends itself with signal 9 before its kill_at-th disk operation (0: never).

    Returns:
        the signal that ended it, 0 if it came to its end.
    """

    def armed() -> None:
        sys.addaudithook(_Bomb(kill_at))
        action()

    status = os.waitpid(fork(armed), 0)[1]
    assert os.waitstatus_to_exitcode(status) in (0, -signal.SIGKILL)
    return -os.waitstatus_to_exitcode(status)


class _Bomb:
    """Counts what Python does to the disk, and ends the process."""

    EVENTS = frozenset({"open", "os.mkdir", "os.remove", "os.rename", "os.truncate"})

    def __init__(self, countdown: int) -> None:
        self.countdown = countdown

    def __call__(self, event: str, _: tuple[Any, ...]) -> None:
        if event in self.EVENTS:
            self.countdown -= 1
            if self.countdown == 0:
                os.kill(os.getpid(), signal.SIGKILL)


def continue_run(case: Case, folder: Path) -> None:
    """What a user does after a crash: resume if there is a folder, else run."""
    if folder.exists():
        resume(folder, make=by(make_model))
    else:
        start(case, folder)


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
@pytest.mark.slow
def test_killed_before_any_disk_operation_and_resumed_equals_unbroken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every operation of a run in turn; the resumed run is killed at the same one, then left to finish."""
    monkeypatch.setattr("fsi.run_folder.folder.SELDOM", 0.0)
    case = small_case(time={"end": 0.05, "first_step": 0.05}, output={"interval": 0.025})
    start(case, tmp_path / "unbroken")
    expected = contents(tmp_path / "unbroken")
    killed = 0
    for operation in range(1, 1000):
        folder = tmp_path / str(operation)
        action = partial(continue_run, case, folder)
        if in_child(action, kill_at=operation) == 0:
            break
        killed += 1
        in_child(action, kill_at=operation)
        assert in_child(action) == 0
        assert contents(folder) == expected
    assert killed > 5 * len(expected["steps.csv"])


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
@pytest.mark.parametrize("seldom", [0.0, 10.0])
def test_killed_at_random_moments_and_resumed_equals_unbroken(
    seldom: float, unbroken: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also between and within writes, which no hook sees; steps are committed one by one, and together."""
    monkeypatch.setattr("fsi.run_folder.folder.SELDOM", seldom)
    case, expected = small_case(), contents(unbroken)
    random = np.random.default_rng(0)
    for attempt in range(5):
        folder = tmp_path / str(attempt)
        for _ in range(3):
            child = fork(partial(continue_run, case, folder))
            time.sleep(random.uniform(0.0, 0.05))
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
        assert in_child(partial(continue_run, case, folder)) == 0
        assert contents(folder) == expected


def refused(folder: Path, launch: Callable[[], object]) -> bool:
    with pytest.raises(InputError, match=rf"output = .*{folder.name}: another process runs this; wait"):
        launch()
    return True


def test_one_launch_at_a_time(unbroken: Path, tmp_path: Path) -> None:
    """A second one would take its launch out of provenance.json, and its rows out of the tables."""
    folder, case, tried = tmp_path / "run", small_case(), []

    def progress(record: StepRecord) -> None:
        if record.step == 3:
            before = contents(folder)
            tried.append(refused(folder, lambda: resume(folder, make=by(make_model))))
            assert contents(folder) == before
            with pytest.raises(InputError, match="exists and is not empty; give another folder"):
                start(case, folder)
        if record.step == 5:
            raise KilledError

    def resumed(record: StepRecord) -> None:
        if record.step == 7:
            tried.append(refused(folder, lambda: resume(folder, make=by(make_model))))

    with pytest.raises(KilledError):
        run(case, folder, progress, make=by(make_model))
    resume(folder, resumed, make=by(make_model))
    assert tried == [True, True]
    assert len(launches(folder)) == 2
    assert contents(folder) == contents(unbroken)


def test_one_run_makes_a_folder_at_a_time(tmp_path: Path) -> None:
    """The second would take away what the first has begun; what a killed one has left is written over."""
    partial = tmp_path / ".run.tmp"
    (partial / "fields").mkdir(parents=True)
    with locked(partial):
        refused(tmp_path / "run", lambda: start(small_case(), tmp_path / "run"))
    start(small_case(), tmp_path / "run")
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_where_nothing_can_be_locked_runs_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on network drives, which lock no folders."""

    def flock(*_: int) -> None:
        raise OSError(errno.EBADF, os.strerror(errno.EBADF))

    monkeypatch.setattr("fcntl.flock", flock)
    break_off(tmp_path / "run", small_case(), step=3)
    assert resume(tmp_path / "run", make=by(make_model)).steps > 0


REFUSED = """
import sys
from pathlib import Path
from fsi.run_folder.alone import alone
with alone(Path(sys.argv[1]), refused=Path("runs/one")):
    print("is alone")
"""


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=needs_mpi)])
def test_all_ranks_are_refused_together(ranks: int, tmp_path: Path) -> None:
    command = [*python_on(ranks), "-c", REFUSED, str(tmp_path)]
    with locked(tmp_path):
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == ""
    assert done.stderr.count("InputError: output = runs/one: another process runs this") == 1
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout.count("is alone") == ranks
