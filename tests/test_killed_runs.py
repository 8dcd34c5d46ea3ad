"""Runs that are killed at any moment, and resumed."""

from __future__ import annotations

import os
import signal
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
from fsi.runs import resume
from tests.exact_model import by
from tests.small_run import contents, make_model, small_case, start


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
