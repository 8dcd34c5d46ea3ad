"""Standard output that is full, closed, or without letters; and the last resort of `main`."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from fsi.cli import cases
from fsi.cli.main import main
from fsi.errors import InputError

ROOT = Path(__file__).parents[2]
FSI = f"{sys.executable} -m fsi"
CHECK = f"{FSI} check cases/disc_in_box.toml"


def shell(command: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """What a line of bash gives; its exit code is that of `fsi`, not of what reads its output."""
    return subprocess.run(
        ["bash", "-c", f"{command}; exit ${{PIPESTATUS[0]}}"],
        capture_output=True, text=True, cwd=ROOT, env=os.environ | environment, check=False,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("command", "code", "words"),
    [
        (f"{CHECK} > /dev/full", 3, "No space left on device"),
        (f"{FSI} keys --markdown > /dev/full", 3, "No space left on device"),
        (f"{CHECK} | true", 0, ""),
        (f"{CHECK} >&-", 0, ""),
        (f"{FSI} check nowhere.toml 2> /dev/full", 2, ""),
        (f"{FSI} check nowhere.toml 2>&-", 2, ""),
        (f"{FSI} new <&-", 2, "--kind: missing"),
        (f"{FSI} solve cases/disc_in_box.toml | true", 0, ""),  # gmsh lets the signal end a program: 141
    ],
)
def test_a_stream_that_takes_nothing_is_one_line_at_most(command: str, code: int, words: str) -> None:
    done = shell(command)
    assert done.returncode == code
    assert words in done.stderr
    assert done.stderr.count("\n") == bool(words)


def test_a_width_of_zero_is_none() -> None:
    """COLUMNS=0 is what shells know of no terminal: nothing at all was printed, and the exit code was 0."""
    assert shell(CHECK, COLUMNS="0").stdout == shell(CHECK).stdout != ""


def test_letters_that_the_encoding_lacks_are_escaped() -> None:
    done = shell(f"{CHECK} --set 'name=\"Düse\"'", PYTHONIOENCODING="ascii")
    assert (done.returncode, done.stderr) == (0, "")
    assert "D\\xfcse" in done.stdout


def test_a_defect_is_one_line_and_leaves_its_text(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError("of\nnothing")

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(cases, "load", fail)
    monkeypatch.setattr(sys, "argv", ["fsi", "check", "case.toml"])
    monkeypatch.setattr(sys, "__stderr__", sys.stderr)
    assert main() == 70
    (text,) = tmp_path.iterdir()
    told = capsys.readouterr().err
    assert told.startswith("error: a defect of the program, ZeroDivisionError: of nothing; ")
    assert str(text) in told
    assert told.count("\n") == 1
    assert "Traceback" in text.read_text()
    assert "in fail" in text.read_text()


def test_a_defect_is_told_where_nothing_can_be_written(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(tempfile, "tempdir", "/nowhere")
    monkeypatch.setattr(cases, "load", fail)
    monkeypatch.setattr(sys, "argv", ["fsi", "check", "case.toml"])
    monkeypatch.setattr(sys, "__stderr__", sys.stderr)
    assert main() == 70
    assert f"at {__file__}:" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (PermissionError(13, "Permission denied", "there"), 2),
        (OSError(28, "No space left"), 3),
        (MemoryError(), 3),
    ],
)
def test_what_the_machine_refuses_is_no_defect(
    error: Exception, code: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr(cases, "load", fail)
    monkeypatch.setattr(sys, "argv", ["fsi", "check", "case.toml"])
    monkeypatch.setattr(sys, "__stderr__", sys.stderr)
    assert main() == code
    assert capsys.readouterr().err.count("\n") == 1


def test_names_that_would_control_the_terminal_are_told_with_their_numbers(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise InputError('bodies.0.name = "\x1b[31mé\u202e": not of that form')

    monkeypatch.setattr(cases, "load", fail)
    monkeypatch.setattr(sys, "argv", ["fsi", "check", "case.toml"])
    monkeypatch.setattr(sys, "__stderr__", sys.stderr)
    assert main() == 2
    line = 'error: bodies.0.name = "\\x1b[31mé\\u202e": not of that form\n'
    assert capsys.readouterr().err == line


@pytest.mark.parametrize("place", ["argument", "folder"])
def test_a_path_that_is_not_of_letters_is_refused(place: str, tmp_path: Path) -> None:
    """DOLFINx and VTK took no such paths, and it was told as a defect, with a long text."""
    bad = os.fsdecode(b"bad\xff")
    here = tmp_path / bad
    here.mkdir()
    command = [sys.executable, "-m", "fsi", "check", bad if place == "argument" else "case.toml"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        command, cwd=tmp_path if place == "argument" else here, env=environment,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "bad\\udcff: has bytes that are no letters; give it a name in UTF-8" in line
