"""Tables in terminals of any width: no number and no word is broken."""

from __future__ import annotations

import io
import re
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.box import SIMPLE_HEAD
from rich.console import Console

from fsi.cli.main import main
from fsi.report.console import FittingTable, table

NUMBERS = st.floats(-1e9, 1e9).map(lambda x: f"{x:.9e}")
WORDS = st.sampled_from(["disc", "its image", "the smallest eigenvalue", "wall_top", "body number 7"])


def printed(shown: FittingTable, width: int) -> str:
    out = io.StringIO()
    Console(file=out, width=width).print(shown)
    return out.getvalue()


def tokens(text: str) -> set[str]:
    """What stands between blanks and lines."""
    return set(re.findall(r"[^\s│┃┏┓┗┛┡┩━─┬┴┼┘└├┤╇╈╃╄┳┻╋]+", text))


ROWS = st.tuples(st.lists(WORDS, min_size=2, max_size=2), st.lists(NUMBERS, min_size=9, max_size=9))


@given(
    words=st.integers(0, 2),
    rows=st.lists(ROWS, min_size=1, max_size=4),
    width=st.sampled_from([40, 60, 80, 100, 120]),
    simple=st.booleans(),
)
def test_no_number_is_broken_at_any_width(
    words: int, rows: list[tuple[list[str], list[str]]], width: int, simple: bool
) -> None:
    """Nine columns of 16 digits want 180 columns; all that is there is there whole, within the width."""
    style = {"box": SIMPLE_HEAD} if simple else {}
    shown = table(
        [f"what {k}" for k in range(words)],
        [f"number {k}" for k in range(9)],
        [(*of[:words], *numbers) for of, numbers in rows],
        title="all of them",
        **style,
    )
    narrow, wide = printed(shown, width), printed(shown, 300)
    assert max(map(len, narrow.splitlines())) <= width
    assert tokens(narrow) == tokens(wide)
    assert "…" not in narrow


def test_a_narrow_terminal_folds_words_and_then_takes_parts() -> None:
    row = ("a disc with a long name", "-1.23456789e+00", "4.5678901234e+01")
    shown = table(("body",), ("V", "omega"), [row])
    assert len(printed(shown, 80).splitlines()) == 5
    folded = printed(shown, 56)
    assert len(folded.splitlines()) > 5
    assert folded.count("body") == 1
    parts = printed(shown, 30)
    assert parts.count("body") == 2
    for text in (folded, parts):
        assert {*row[1:]} <= tokens(text)


def test_brackets_in_words_are_shown() -> None:
    """Rich would take them for markup."""
    assert "[bold] disc" in printed(table(["name"], ["U"], [("[bold] disc", "1.5")]), 80)


def test_rows_follow_each_other_without_blank_lines() -> None:
    assert len(printed(table(("body",), ("V",), [("a", "1"), ("b", "2"), ("c", "3")]), 80).splitlines()) == 7


@pytest.mark.parametrize("width", [40, 60, 80])
def test_words_alone_are_folded_between_words(width: int) -> None:
    """As `fsi check` has it: places and gaps among words."""
    rows = [("disc", "-1.23456, 7.65432", "0.123456", "the image of disc", "free", "held", "free")]
    shown = table(("body", "position", "smallest gap", "to", "V_x", "V_y", "omega"), (), rows)
    assert tokens(printed(shown, width)) == tokens(printed(shown, 300))


@pytest.mark.parametrize(
    "command",
    [
        ["check", "couette_N10.toml"],
        ["check", "spheres_in_space.toml"],
        ["keys"],
        ["resistance", "two_discs.toml", "--set", "discretisation.cells_per_circle=12"],
    ],
)
def test_commands_break_no_number_in_a_terminal(
    command: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Numbers of a terminal of 300 columns, but for CPU seconds, against those of 80, 60 and 40."""
    cases = Path(__file__).parents[2] / "cases"
    line = [str(cases / word) if word.endswith(".toml") else word for word in command]
    monkeypatch.setattr(sys, "argv", ["fsi", *line])
    found = {}
    for columns in (300, 80, 60, 40):
        monkeypatch.setenv("COLUMNS", str(columns))
        assert main() == 0
        said = [text for text in capsys.readouterr().out.splitlines() if "CPU" not in text]
        found[columns] = {word for word in tokens("\n".join(said)) if re.search(r"\d\.\d", word)}
    seconds = {word for word in found[300] if re.fullmatch(r"\d+\.\d\d,?", word)}
    for columns in (80, 60, 40):
        assert found[300] - seconds <= found[columns]
