"""What the pages tell a reader to type can be typed: all of it is understood, and run."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from unittest import mock

import pytest
import typer

from fsi.cli.main import app

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
WORDS = (
    "fsi",
    "python",
    "pytest",
    "make",
    "pip",
    "dask",
    "jupyter",
    "mpiexec",
    r"\./bootstrap\.sh",
    r"\.venv/bin/\w+",
)
TYPED = f"(?:{'|'.join(WORDS)}) [^`\n]*"


def commands(page: Path) -> list[str]:
    """What a page tells to type, in its order: spans and lines of code that begin with a program."""
    text = page.read_text(encoding="utf-8").replace("\\\n", " ")
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)  # of Python and TOML
    text = re.sub(r"`[^`]*`", lambda span: span[0].replace("\n", " "), text)  # spans may be broken
    found = re.findall(rf"`({TYPED})`|^ {{4}}(?:\$ )?({TYPED})$", text, flags=re.MULTILINE)
    return [" ".join(re.split(r"\s{2,}#", span or line)[0].split()) for span, line in found]


def is_whole(command: str) -> bool:
    """Whether it is a command to type: no name alone, nothing in CAPITALS for what to put in, no dots."""
    words = command.split()[1:]
    named = any(not word.startswith("-") for word in words[1:]) or not command.startswith("fsi ")
    return named and not any(re.search(r"^[A-Z_]+$|\.\.\.|KEY|=A,", word) for word in words)


PRINTED = {page.name: list(dict.fromkeys(filter(is_whole, commands(page)))) for page in PAGES}
ALL = sorted({command for found in PRINTED.values() for command in found})
# Shown to say what is wrong with it.
REFUSED = "fsi solve cases/disc_in_box.toml --set fluid.viscosty=2"


def require_files(words: list[str]) -> None:
    """The cases, scripts and tests that words name are in the checkout."""
    for word in words:
        if re.match(r"(cases|docs|bench|tests)/", word) and "*" not in word:
            assert (ROOT / word).exists(), word


def require_understood(command: str) -> None:
    """Its program and options are known, and its files are there; nothing is run."""
    program, *words = shlex.split(command)
    require_files(words)
    match Path(program).name:
        case "mpiexec":
            assert words[0] == "-n"
            require_understood(shlex.join(words[2:]))
        case "fsi":
            with mock.patch("typer.core.TyperCommand.invoke") as invoke:
                typer.main.get_command(app).main(words, prog_name="fsi", standalone_mode=False)
            assert invoke.called
        case "python":
            assert find_spec(words[1]) if words[0] == "-m" else (ROOT / words[0]).suffix == ".py"
        case "make":
            targets = re.findall(r"^([a-z ]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
            assert words[0] in " ".join(targets).split()
        case "bootstrap.sh":
            assert words[0] in ("run", "test", "install")
        case "pytest":
            assert any(word.startswith("tests/") for word in words)
        case other:
            known = {"pip": ("install", "wheel"), "dask": ("scheduler", "worker"), "jupyter": ("nbconvert",)}
            assert words[0] in known[other]


def test_there_are_commands() -> None:
    assert len(ALL) > 100
    for program in ("fsi", "python", "./bootstrap.sh", "make"):
        assert any(command.startswith(program) for command in ALL)


@pytest.mark.parametrize("command", ALL)
def test_a_command_of_the_pages_is_understood(command: str) -> None:
    require_understood(command)


# What only `pytest -m hours` runs, and why; some of these are run by tests of their own.
_RUNS = (
    "history|crowd|attraction|no_attraction|collapse|couette|pores_history|pores_pressure|spheres|layers"
    "|sheared_cell"
)
EXPENSIVE = {
    r"fsi run cases/(suspensions|pores|gluey/collapse|gluey/layers|spheres_in|pair_in|couette)": "minutes",
    r"fsi run cases/(settling_disc\.|sheared_cell)": "a minute: tests/test_run_resolved.py has their like",
    r"fsi run cases/shapes/sliding": "a minute: tests/stokes/test_contact.py runs it",
    rf" runs/({_RUNS})|runs/settling_disc($| )": "of a run of minutes",
    r"fsi (sweep|search) ": "tens of runs: tests/studies has smaller ones",
    r"fsi compare ": "runs at several levels: tests/comparison has smaller ones",
    r"fsi calibrate ": "twenty samples: tests/calibration has fewer",
    r"fsi validate (?!concentric)": "minutes: docs/validation has what it gives",
    r"fsi solve cases/(sphere_in_space|pores/sheared_cell)": "minutes of a solve in space, or of many modes",
    r"settling_discs": "two minutes, for README alone",
}
FIRST = ("README.md", "index.md")


def runs_here(page: str, command: str) -> bool:
    """Whether a command is run: all of the first pages but what takes minutes, elsewhere what is quick."""
    if not command.startswith("fsi ") or command == REFUSED:
        return False
    reasons = EXPENSIVE if page not in FIRST else [r"fsi (validate|calibrate) "]
    return not any(re.search(reason, command) for reason in reasons)


RUN = {page: [one for one in found if runs_here(page, one)] for page, found in PRINTED.items()}


def run_in_order(typed: list[str], folder: Path) -> None:
    """Type commands in a folder that has the cases and pages of a checkout; all must end well."""
    for name in ("cases", "docs"):
        shutil.copytree(ROOT / name, folder / name)
    failed, environment = [], os.environ | {"PYTHONPATH": str(ROOT)}
    for command in typed:
        for made_anew in ("runs/validation", "docs/validation", "runs/sweep"):  # these want a new folder
            shutil.rmtree(folder / made_anew, ignore_errors=True)
        line = [sys.executable, "-m", *shlex.split(command)]
        done = subprocess.run(line, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            failed.append(f"{command}: {done.stderr}")
    assert failed == []


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page, found in RUN.items() if found])
def test_quick_commands_of_a_page_run_in_their_order(page: str, tmp_path: Path) -> None:
    run_in_order(RUN[page], tmp_path)


def folder_of(command: str) -> str | None:
    """Where `fsi run` of a command writes, "runs/NAME"; None of another command."""
    words = shlex.split(command)
    if words[:2] != ["fsi", "run"]:
        return None
    if "-o" in words:
        return words[words.index("-o") + 1]
    return f"runs/{Path(words[2]).stem}"


MAKERS = {folder: command for command in reversed(ALL) if (folder := folder_of(command))}


def with_makers(typed: list[str]) -> list[str]:
    """Commands, before each those that make the runs it reads where none before it has."""
    whole: list[str] = []
    for command in typed:
        there = {folder_of(each) for each in whole}
        needed = [word for word in shlex.split(command) if word in MAKERS and word != folder_of(command)]
        whole += [MAKERS[folder] for folder in needed if folder not in there]
        whole += [command] if command not in whole else []
    return whole


EVERY = {
    page: with_makers([each for each in found if each.startswith("fsi ") and each != REFUSED])
    for page, found in PRINTED.items()
}


@pytest.mark.hours
@pytest.mark.parametrize("page", [page for page, found in EVERY.items() if found != RUN[page]])
def test_every_command_of_a_page_runs_in_its_order(page: str, tmp_path: Path) -> None:
    run_in_order(EVERY[page], tmp_path)


def script_of(words: list[str]) -> Path:
    """The file that `python ...` runs."""
    return ROOT / (words[1].replace(".", "/") + ".py" if words[0] == "-m" else words[0])


SCRIPTS = [each for each in ALL if each.startswith("python ") and not each.startswith("python -m pytest ")]
TAKING_OPTIONS = ("typer", "argparse")  # what a script that takes some says in its source


@pytest.mark.slow
@pytest.mark.parametrize("command", SCRIPTS)
def test_scripts_of_the_pages_know_their_options(command: str) -> None:
    """Benchmarks take minutes to hours: they begin, and tell what they take; some take nothing."""
    words = shlex.split(command)[1:]
    options = [word for word in words[1:] if word.startswith("--")]
    source = script_of(words).read_text(encoding="utf-8")
    if not any(name in source for name in TAKING_OPTIONS):
        assert options == []
        return
    run = [sys.executable, *words[: 2 if words[0] == "-m" else 1], "--help"]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "NO_COLOR": "1", "COLUMNS": "200"}
    done = subprocess.run(run, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert [option for option in options if option not in done.stdout] == []
