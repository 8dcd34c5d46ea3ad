"""What `fsi sweep` prints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from fsi.report.sweep import OF_MOTION, print_averages
from fsi.studies.sweep import Average, SweepPlan, SweptKey


@pytest.mark.parametrize(
    ("seeds", "motion", "error", "bar", "said"),
    [
        (0, False, 4.6e-4, "5e-04", "±: the estimated error of the value"),
        (1, False, 4.6e-4, "5e-04", "±: the estimated error of the value"),
        (0, True, 4.6e-4, "5e-04", OF_MOTION),
        (0, False, np.nan, "", None),
        (2, False, 4.6e-4, "0.013", "±: the standard error of the mean over seeds"),
    ],
)
def test_each_value_has_its_bar(seeds: int, motion: bool, error: float, bar: str, said: str | None) -> None:
    """Of a lone run that of its value, with one digit as everywhere; of several runs that of their mean."""
    plan = SweepPlan(Path(), (), [SweptKey("model", ["pores"])], seeds, ("q",), motion, Path())
    spread = (0.0126, 0.0252) if seeds > 1 else (np.nan, np.nan)
    found = [Average({"model": "pores"}, "q", 2.5, *spread, max(seeds, 1), 0, error)]
    console = Console(width=140)
    with console.capture() as capture:
        print_averages(console, plan, found)
    lines = capture.get().splitlines()
    (row,) = (line for line in lines if "pores" in line)
    deviation = "0.025" if seeds > 1 else ""
    expected = ["pores", "2.5", bar, deviation, str(max(seeds, 1)), ""]
    assert [cell.strip() for cell in row.strip("│").split("│")] == expected
    assert [line for line in lines if line.startswith("±")] == ([said] if said else [])
