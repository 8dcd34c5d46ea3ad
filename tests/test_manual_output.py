"""What the manual says that the commands print is what they print: words, and numbers to the digits shown."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
# Below it a number is an error of the mesh: known to a factor.
NOISE, FACTOR = 1e-5, 3.0
SECONDS = ("s", "s)", "CPU")


def blocks() -> dict[str, list[str]]:
    """The blocks of output in the manual by the command that stands before each, the last `fsi ...` there."""
    text = (ROOT / "docs" / "manual.md").read_text(encoding="utf-8")
    paragraphs = [part for part in re.split(r"\n\s*\n", text) if not part.startswith("![")]
    found = {}
    for before, block in pairwise(paragraphs):
        lines = block.splitlines()
        commands = re.findall(r"`(fsi [a-z][^`]*)`", before)
        output = lines and all(line.startswith("    ") for line in lines)
        if output and commands and not lines[0].startswith(("    fsi ", "    import ")):
            command = commands[-1] if "validate" not in commands[-1] else commands[0]
            found[" ".join(command.split())] = lines
    return found


def words(line: str) -> list[str]:
    """A line without the bars of a table."""
    return re.sub("[│┃|]", " ", line).split()


def number(word: str) -> float | None:
    """A number, also in front of a comma, a semicolon or a bracket."""
    try:
        return float(word.strip("(),;%"))
    except ValueError:
        return None


def last_digit(word: str) -> float:
    """The size of one unit of the last digit that is printed."""
    mantissa, _, exponent = word.strip("(),;%").lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return float(10.0 ** (int(exponent or 0) - decimals))


def same(said: str, printed: str) -> bool:
    """Whether two words are the same, or numbers that agree to the digits shown; counts are those printed."""
    a, b = number(said), number(printed)
    if a is None or b is None:
        return said == printed
    if abs(a) < NOISE and last_digit(said) < NOISE:
        return abs(b) <= FACTOR * abs(a) and abs(a) <= FACTOR * abs(b)
    counts = said.strip("(),;%").isdecimal() and printed.strip("(),;%").isdecimal()
    return abs(a - b) <= (0.0 if counts else 1.001 * last_digit(said))


def agrees(said: str, printed: str) -> bool:
    """Whether a line of the manual is that printed line, or a part of it, whatever the seconds."""
    one, other = words(said), words(printed)
    following = [*one[1:], ""]

    def begins_at(k: int) -> bool:
        return all(
            same(a, b) or (number(a) is not None and number(b) is not None and after in SECONDS)
            for a, b, after in zip(one, other[k:], following, strict=False)
        )

    return any(begins_at(k) for k in range(len(other) - len(one) + 1))


def require_printed(said: list[str], printed: str) -> None:
    """Every line that the manual shows is printed, in that order."""
    rest = printed.splitlines()
    for line in said:
        if line.strip() == "...":
            continue
        place = next((k for k, one in enumerate(rest) if agrees(line, one)), None)
        assert place is not None, f"The manual says:\n{line}\nwhich is not in what is printed:\n{printed}"
        rest = rest[place + 1 :]


def call(command: str, folder: Path) -> str:
    """What a command prints in a folder that has the cases."""
    if not (folder / "cases").exists():
        (folder / "cases").symlink_to(ROOT / "cases")
    environment = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "300"}
    line = [sys.executable, "-m", *command.split()]
    done = subprocess.run(
        line, cwd=folder, env=environment, capture_output=True, text=True, timeout=1800, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


# Those that take longer, with what must have been run before.
QUICK = (
    "fsi cases",
    "fsi check cases/two_discs.toml",
    "fsi solve cases/disc_in_box.toml",
    "fsi resistance cases/disc_in_box.toml -o R.npz",
    "fsi pack random --number 40 --gap 0.02 --seed 1 -o random.json",
)
SLOW = {
    "fsi solve cases/pores/couette_N10.toml": "",
    "fsi analyse settling runs/settling_disc": "fsi run cases/settling_disc.toml",
    "fsi validate": "",
    "fsi calibrate cases/calibration/sphere_wall.toml": "",
    "fsi compare cases/compare_stack.toml": "",
    "fsi run cases/settling_discs.toml": "",
}


def test_each_block_of_the_manual_is_compared() -> None:
    assert set(blocks()) == {*QUICK, *SLOW}


@pytest.mark.parametrize(
    "command", [*QUICK, *(pytest.param(command, marks=pytest.mark.slow) for command in SLOW)]
)
def test_the_manual_shows_what_is_printed(command: str, tmp_path: Path) -> None:
    if command == "fsi cases":
        (tmp_path / "new").mkdir()
        require_printed(blocks()[command], call_in_empty(command, tmp_path / "new"))
        return
    if SLOW.get(command):
        call(SLOW[command], tmp_path)
    require_printed(blocks()[command], call(command, tmp_path))


def call_in_empty(command: str, folder: Path) -> str:
    """The same where there are no cases yet."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    line = [sys.executable, "-m", *command.split()]
    return subprocess.run(
        line, cwd=folder, env=environment, capture_output=True, text=True, check=True
    ).stdout


@pytest.mark.parametrize(
    ("said", "printed", "agree"),
    [
        ("gap 0.04517, 3 s", "gap 0.04517, 8 s", True),
        ("gap 0.04517, 3 s", "gap 0.04519, 3 s", False),
        ("gap 0.045", "gap 0.0454", True),
        ("gap 0.045", "gap 0.0471", False),
        ("-3e-07 of 0.5", "2e-07 of 0.5", True),
        ("-3e-07", "-2e-06", False),
        ("-3.6e-04", "-3.8e-04", False),
        ("held 1", "free 1", False),
        ("wrote 113 cases", "wrote 114 cases", False),
        ("gap 1", "gap 1.0002", True),
    ],
)
def test_lines_agree_to_the_digits_shown(said: str, printed: str, agree: bool) -> None:
    assert agrees(said, printed) is agree
