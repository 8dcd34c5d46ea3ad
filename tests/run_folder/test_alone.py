"""A folder is run by one process at a time."""

from __future__ import annotations

import errno
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from fsi.errors import InputError
from fsi.integration.state import StepRecord
from fsi.run_folder.alone import locked
from fsi.runs import resume, run
from tests.exact_model import by
from tests.ranks import needs_mpi, python_on
from tests.small_run import KilledError, break_off, contents, launches, make_model, small_case, start


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
