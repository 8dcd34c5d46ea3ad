"""What commands do for habits: completion, quiet runs, the next command, a run that is watched or drawn."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from fsi.report import watch
from fsi.report.watch import complete_rows, line
from tests.commands import fsi_command

ROOT = Path(__file__).parents[2]
DISCS = [ROOT / "cases" / "gluey" / "two_discs.toml", "--set", "time.end=1", "--set", "time.step=0.25"]


@pytest.mark.parametrize(("typed", "word"), [("fsi sw", "sweep"), ("fsi run --outp", "--output")])
def test_the_shell_completes_words(
    typed: str, word: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, value in {
        "_FSI_COMPLETE": "complete_bash",
        "COMP_WORDS": typed,
        "COMP_CWORD": str(typed.count(" ")),
        "COLUMNS": "80",
    }.items():
        monkeypatch.setenv(name, value)
    assert fsi_command() == 0
    said = capsys.readouterr()
    assert (said.out.split(), said.err) == ([word], "")


@pytest.mark.parametrize(
    ("shell", "begin", "end"),
    [("fish", "--field\tspeed, ", "."), ("zsh", '_arguments \'*: :(("--field":', "))'")],
)
def test_each_candidate_is_one_line(
    shell: str, begin: str, end: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In a terminal of 80 columns the 118 letters of its help were two candidates, the second no option."""
    for name, value in {
        "_FSI_COMPLETE": f"complete_{shell}",
        "_TYPER_COMPLETE_ARGS": "fsi render --fi",
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
        "COLUMNS": "80",
    }.items():
        monkeypatch.setenv(name, value)
    assert fsi_command() == 0
    line = capsys.readouterr().out.removesuffix("\n")
    assert "\n" not in line
    assert line.startswith(begin)
    assert line.endswith(end)


def test_a_run_names_the_next_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for fields, command in (("true", "render"), ("false", "plot")):
        folder = tmp_path / command
        assert fsi_command("run", *DISCS, "-o", folder, "--set", f"output.fields={fields}") == 0
        assert capsys.readouterr().out.splitlines()[-1] == f"look at it with: fsi {command} {folder}"


def test_a_quiet_run_says_nothing(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert fsi_command("run", *DISCS, "-o", tmp_path / "run", "--quiet") == 0
    assert fsi_command("resume", tmp_path / "run", "-q") == 0
    assert capfd.readouterr() == ("", "")
    assert fsi_command("run", *DISCS, "-o", tmp_path / "run", "-q") == 2  # errors are said
    assert "exists and is not empty" in capfd.readouterr().err


def test_a_run_is_watched_to_its_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One line a step, of whole lines of its table alone."""
    folder = tmp_path / "run"
    assert fsi_command("run", *DISCS, "-o", folder, "--quiet") == 0
    table = folder / "steps.csv"
    whole = table.read_text()
    steps = whole.count("\n") - 1
    assert fsi_command("watch", folder) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == steps
    assert all(" of " in each and "smallest gap" in each for each in lines)
    table.write_text(f"{whole}{steps},1.2")
    assert len(complete_rows(folder)) == steps
    assert fsi_command("watch", folder, "--once") == 0
    assert len(capsys.readouterr().out.splitlines()) == steps


def test_a_run_that_has_begun_no_table_is_waited_for(tmp_path: Path) -> None:
    assert complete_rows(tmp_path) == []


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda whole: whole[:-5], "5 bytes are missing at its end"),
        (lambda whole: whole.replace(b"0.25", b"\xb0.25", 1), "'utf-8' codec can't decode byte 0xb0"),
        (lambda whole: whole.replace(b"0.25", b"a.25", 1), "could not convert string to float: 'a.25'"),
        (lambda whole: whole.replace(b"0.25", b"0,25", 1), "rows are not of one width"),
        (lambda whole: whole.replace(b"0.25", b"0.26", 1), "its rows are others than were written"),
        (lambda whole: whole.replace(b",t,", b",u,", 1), "does not begin with the columns step, t, h,"),
    ],
)  # fmt: skip
def test_a_damaged_run_is_not_watched(
    damage: Callable[[bytes], bytes], words: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """One line, where it would be waited for in vain, or be a defect of the program."""
    folder = tmp_path / "run"
    assert fsi_command("run", *DISCS, "-o", folder, "--quiet") == 0
    table = folder / "steps.csv"
    table.write_bytes(damage(table.read_bytes()))
    assert fsi_command("watch", folder, "--once") == 2
    told = capfd.readouterr()
    assert told.err.startswith(f"error: run = {folder}: a file is damaged (steps.csv: {words}")
    assert (told.err.count("\n"), told.out) == (1, "")


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (["state.npz", "steps.csv"], "state.npz is of another one than provenance.json"),
        (["case.toml"], "this is not the one it began with: time.step = 0.25 -> 0.5"),
    ],
)
def test_a_folder_of_two_runs_is_not_watched(
    names: list[str], words: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """The steps of the one were printed with the end of the other."""
    folder, other = tmp_path / "run", tmp_path / "other"
    assert fsi_command("run", *DISCS, "-o", folder, "--quiet") == 0
    assert fsi_command("run", *DISCS, "--set", "time.step=0.5", "-o", other, "--quiet") == 0
    for name in names:
        (folder / name).write_bytes((other / name).read_bytes())
    assert fsi_command("watch", folder, "--once") == 2
    told = capfd.readouterr()
    assert words in told.err
    assert (told.err.count("\n"), told.out) == (1, "")


def test_what_is_left_is_told_by_what_has_been_spent() -> None:
    """A quarter of the time took 3 s, so three quarters take 9."""
    row = {"step": 5.0, "t": 0.5, "smallest_gap": 0.01, "apparent_viscosity": 4.25}
    assert line(row, 2.0, 3.0) == (
        "step 5  t = 0.5 of 2  smallest gap 1.000e-02  apparent viscosity 4.25  some 9 CPU s left"
    )


def test_only_runs_are_watched(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert fsi_command("watch", tmp_path) == 2
    assert "not a run folder" in capfd.readouterr().err


def test_a_plot_follows_a_run(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Drawn when there are steps, again when there are more, and no more after the last."""
    folder = tmp_path / "run"
    assert fsi_command("run", *DISCS, "-o", folder, "--quiet") == 0
    rows = complete_rows(folder)
    looks = iter([[], rows[:1], rows[:1], rows])
    monkeypatch.setattr(watch, "complete_rows", lambda _: next(looks))
    monkeypatch.setattr(watch, "PAUSE", 0.0)
    assert fsi_command("plot", folder, "--follow", "-o", tmp_path / "gaps.svg") == 0
    assert capfd.readouterr().out.count("gaps.svg") == 2
    assert (tmp_path / "gaps.svg").is_file()
    assert fsi_command("plot", folder, folder, "--follow") == 2
    assert fsi_command("plot", tmp_path, "--follow") == 2
    assert "not a run folder" in capfd.readouterr().err


@pytest.mark.slow
def test_a_plot_follows_a_run_of_another_process(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "fsi"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    folder = tmp_path / "run"
    long = [str(word) for word in DISCS] + ["--set", "time.step=0.002", "--set", "output.fields=false"]
    with subprocess.Popen([*command, "run", *long, "-o", folder, "-q"], env=environment) as run:
        while not (folder / "state.npz").exists():
            assert run.poll() is None
            time.sleep(0.05)
        followed = subprocess.run(
            [*command, "plot", folder, "--follow"],
            env=environment, capture_output=True, text=True, check=True, timeout=300,
        )  # fmt: skip
    assert run.returncode == 0
    assert followed.stdout.count("history.png") >= 2
