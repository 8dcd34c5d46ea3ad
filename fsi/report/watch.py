"""`fsi watch`: the steps of a run as lines, while another process makes it."""

import csv
import time
from collections.abc import Iterator, Mapping
from math import inf
from pathlib import Path

from rich.console import Console

from fsi.run_folder.kept import STEPS

PAUSE = 1.0  # seconds between two looks


def follow(console: Console, folder: Path, end: float, contact_gap: float | None, *, once: bool) -> None:
    """Print a line for each step up to the end of time, or to contact; once: for those that are there."""
    spent = 0.0
    for rows in arrivals(folder, end, contact_gap, once=once):
        for row in rows:
            spent += float(row.get("cpu_step", "nan"))
            console.print(line(row, end, spent), highlight=False)


def arrivals(
    folder: Path, end: float, contact_gap: float | None, *, once: bool = False
) -> Iterator[list[dict[str, str]]]:
    """The new rows of steps.csv, look by look, at least one each; the last with the end of the run."""
    seen = 0
    while True:
        new = list(complete_rows(folder / STEPS))[seen:]
        seen += len(new)
        if new:
            yield new
        over = (float(row["t"]) >= end or float(row["smallest_gap"]) <= (contact_gap or -inf) for row in new)
        if once or any(over):
            return
        time.sleep(PAUSE)


def complete_rows(table: Path) -> Iterator[dict[str, str]]:
    """The rows of a table up to its last line end: what comes after is being written."""
    text = table.read_text(encoding="utf-8") if table.is_file() else ""
    yield from csv.DictReader(text[: text.rfind("\n") + 1].splitlines())


def line(row: Mapping[str, str], end: float, spent: float) -> str:
    """A step, the part of the time that it has reached, and the CPU seconds that the rest may take."""
    t = float(row["t"])
    parts = [
        f"step {row['step']}",
        f"t = {t:.4g} of {end:g}",
        f"smallest gap {float(row['smallest_gap']):.3e}",
    ]
    if "apparent_viscosity" in row:
        parts.append(f"apparent viscosity {float(row['apparent_viscosity']):.5g}")
    if 0.0 < t < end:
        parts.append(f"some {spent * (end - t) / t:.0f} CPU s left")
    return "  ".join(parts)
