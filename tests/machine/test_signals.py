"""Signals that end the program: held back while libraries load, told to what is open, nobody else's."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from weakref import ref

import pytest

from fsi.machine.signals import Ended, heard, held
from fsi.workers.launch import launched
from fsi.workers.pools import local
from tests.commands import fsi_command
from tests.scripts import script

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@pytest.fixture(autouse=True)
def handlers_stay() -> Iterator[None]:
    usual = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored behind a shell's `&`
    before = [signal.getsignal(number) for number in ENDING]
    yield
    assert [signal.getsignal(number) for number in ENDING] == before
    signal.signal(signal.SIGINT, usual)


def test_ctrl_c_comes_after_what_is_held() -> None:
    done = []

    @held()
    def load() -> None:
        os.kill(os.getpid(), signal.SIGINT)
        with held():  # as what loads has others load
            signal.raise_signal(signal.SIGINT)
        done.append("loaded")

    with pytest.raises(KeyboardInterrupt):
        load()
    assert done == ["loaded"]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_is_raised_once_and_its_exit_code_is_that_of_shells(number: signal.Signals) -> None:
    """128 and the number, as POSIX shells give it: 143, 129. systemd sends both, one after the other."""
    cleaned = []

    @heard()
    def work() -> None:
        try:
            signal.raise_signal(number)
        finally:
            signal.raise_signal(signal.SIGHUP)
            cleaned.append("up")

    with pytest.raises(Ended) as raised:
        work()
    assert (raised.value.code, raised.value.signal) == (128 + number, number.name)
    assert cleaned == ["up"]


def test_what_is_ignored_stays_so() -> None:
    """`nohup` lets programs ignore SIGHUP, also if a library sets a handler as it loads."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with heard():
            with held():
                signal.signal(signal.SIGHUP, signal.SIG_DFL)
            signal.raise_signal(signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)


class Dropped:
    """Whose clean-up is broken off by Ctrl-C."""


def test_ctrl_c_that_python_drops_comes_once_more() -> None:
    """As it was in a reference that importlib keeps: the run went on to its end."""
    kept = [Dropped()]
    watched = ref(kept[0], lambda _: signal.raise_signal(signal.SIGINT))

    @heard()
    def work() -> None:
        kept.clear()
        for _ in range(500):  # a sleep would go on to its end
            time.sleep(0.01)

    with pytest.raises(KeyboardInterrupt):
        work()
    assert watched() is None


def test_no_library_takes_the_signals() -> None:
    """PETSc printed pages and left with 15, UCX printed pages, gmsh ended the process at once."""
    lines = """
        import signal
        from fsi.machine.signals import heard
        with heard():
            import fsi.meshes.backend as backend
            from fsi.meshes.planar.triangulate import gmsh_model
            with gmsh_model():
                backend.petsc_forms()
                signal.raise_signal(signal.SIGTERM)
    """
    done = script(lines)
    assert (done.returncode, done.stdout, done.stderr) == (143, "", "")


def test_the_command_says_in_one_line_what_ended_it(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """And how it goes on, where it does: a check was told of runs and sweeps."""
    for load in ("cases.load", "run.load", "calibrate.load_with_flow"):
        monkeypatch.setattr(f"fsi.cli.{load}", lambda *_: signal.raise_signal(signal.SIGTERM))
    for command, goes_on in {
        "check": "",
        "run": "; a run goes on with fsi resume",
        "calibrate": "; it goes on when repeated",
    }.items():
        assert fsi_command(command, "case.toml") == 143
        assert capfd.readouterr().err == f"error: ended by SIGTERM{goes_on}\n"


def test_runs_of_a_study_end_with_what_breaks_it_off(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Each waits for the end of its standard input; nothing ended it, and the study waited for theirs."""
    waits = tmp_path / "waits"
    waits.write_text("#!/bin/sh\ntimeout 60 cat\n")
    waits.chmod(0o755)
    monkeypatch.setattr("fsi.workers.launch.sys.executable", str(waits))
    began = time.monotonic()

    def study() -> None:
        with local(1) as pool:
            pool.submit(launched, "sweep-run", str(tmp_path), 1)
            time.sleep(1.0)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        study()
    assert time.monotonic() - began < 20.0
