"""A part of the storm of mutations (`bench/storm.py`): nothing makes the program fall over."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def storm(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "bench.storm", *arguments],
        cwd=ROOT, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False,
    )  # fmt: skip


def test_fifteen_trials_of_cases() -> None:
    commands = ("check", "check", "keys", "limit", "pack", "run")
    done = storm("--count", "15", *(f"--only={command}" for command in commands))
    assert done.returncode == 0, done.stdout
    assert "15 trials, 0 failed" in done.stdout


@pytest.mark.slow
def test_four_hundred_trials_of_everything() -> None:
    done = storm("--count", "400", "--seed", "100000")
    assert done.returncode == 0, done.stdout


def test_what_a_storm_calls_a_fault() -> None:
    """A storm that finds nothing must be able to find something."""
    from bench.storm import fault_of

    sound = {"timed_out": False, "interrupted": False}
    assert fault_of(0, "", **sound) is None
    assert fault_of(2, "error: fluid: missing\n", **sound) is None
    assert fault_of(1, "", **sound) == "exit code 1"
    assert fault_of(70, "error: a defect\n", **sound) == "exit code 70"
    assert fault_of(130, "error: interrupted\n", **sound) == "exit code 130"
    assert fault_of(-7, "", **sound) == "ended by SIGBUS"
    assert fault_of(2, "error: one\nerror: two\n", **sound) == "2 lines of an error"
    assert fault_of(3, "", **sound) == "0 lines of an error"
    assert fault_of(0, "x.py:1: RuntimeWarning: overflow\n", **sound) is not None
    assert fault_of(-9, "", timed_out=True, interrupted=False) is not None
    assert fault_of(-9, "note: 1e9 steps\n", timed_out=True, interrupted=False) is None
