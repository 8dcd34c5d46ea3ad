"""What is printed of a study of the limit, and of a validation, by hand."""

from __future__ import annotations

import io

import numpy as np
import pytest
from rich.console import Console

from fsi.case.gluey import LimitStudy
from fsi.gluey.limit import Path
from fsi.gluey.limit_study import Study
from fsi.report.studies import print_rows, print_study
from fsi.validation.rows import Row


def test_the_order_is_that_between_two_numbers_of_steps() -> None:
    """Errors 1e-2, 2.5e-3 and 6.25e-4 / 8 at 100, 200, 800 steps: orders 2, and log 32 / log 4 = 2.5."""
    t = np.zeros(1)
    path = Path(t, t, t, 1)
    wanted = LimitStudy(eps=(1e-2,), steps=(100, 200, 800))
    study = Study(
        t, t, t, (path,), np.array([2e-2]), np.array([3e-2]), np.array([1e-2, 2.5e-3, 6.25e-4 / 8.0]),
        [(1.0, 2.5), (4.0, np.inf)], wanted,
    )  # fmt: skip
    console = Console(file=io.StringIO(), width=100)
    print_study(console, study)
    printed = console.file.getvalue()  # type: ignore[attr-defined]
    assert "sticks at t = 1, is released at t = 2.5" in printed
    assert "sticks at t = 4, is not released" in printed
    rows = [line.replace("│", " ").split() for line in printed.splitlines()]
    assert ["1e-02", "2.000e-02", "2.000", "3.000e-02"] in rows
    assert ["200", "2.500e-03", "2.000"] in rows
    assert [row[-1] for row in rows if row[:1] == ["800"]] == ["2.500"]


@pytest.mark.parametrize(("steps", "order"), [(150, np.log(2.0) / np.log(1.5)), (200, 1.0)])
def test_half_the_error_at_more_steps(steps: int, order: float) -> None:
    t = np.zeros(1)
    wanted = LimitStudy(eps=(1e-2,), steps=(100, steps))
    study = Study(t, t, t, (Path(t, t, t, 1),), t, t, np.array([1e-2, 5e-3]), [], wanted)
    console = Console(file=io.StringIO(), width=100)
    print_study(console, study)
    assert f"{order:.3f}" in console.file.getvalue()  # type: ignore[attr-defined]


def test_verdicts_are_words() -> None:
    """Cells are plain text: what is green or red on a terminal shows no brackets elsewhere."""

    def row(value: float) -> Row:
        return Row("disc", None, 0.1, "disc.force.x", value, 1e-6, 0.0, 2.0, 0.0, 1e-3, "", "by hand")

    printed = io.StringIO()
    print_rows(Console(file=printed, width=120), [row(2.0001), row(2.1)])
    rows = [line.split() for line in printed.getvalue().splitlines()]
    assert [one[-1] for one in rows if one[:1] == ["disc.force.x"]] == ["ok", "FAIL"]
    assert ["disc"] in rows
    assert "[" not in printed.getvalue()
