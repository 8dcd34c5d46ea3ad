"""What `fsi sweep` prints, and its tables."""

import os
from collections.abc import Sequence

import numpy as np
from rich.console import Console

from fsi.files import csv_text, write_whole
from fsi.report.console import table
from fsi.studies.sweep import SEED, Average, SweepPlan, SweepRow, value_text

TABLE, RUNS = "sweep.csv", "runs.csv"
OF_MOTION = (
    "±: the error between steps; it lacks those of steps and elements, but for times at gaps of runs with "
    "error estimates"
)
_NUMBERS = ("mean", "standard_error", "deviation", "count", "failed", "error")


def print_averages(console: Console, plan: SweepPlan, found: Sequence[Average]) -> None:
    """A row for each point, a table for each quantity."""
    for quantity in plan.quantities:
        shown = table((), (*(key.name for key in plan.keys), quantity, "±", "deviation", "runs", "failed"))
        for one in (one for one in found if one.quantity == quantity):
            bar = f"{one.standard_error:.2g}" if plan.averaged else f"{one.error:.0e}"
            spread = (text if "nan" not in text else "" for text in (bar, f"{one.deviation:.2g}"))
            mean = f"{one.mean:.8g}" if one.count else ""
            shown.add_row(
                *map(value_text, one.point.values()), mean, *spread, str(one.count), str(one.failed or "")
            )
        console.print(shown)
    if plan.averaged:
        console.print("±: the standard error of the mean over seeds", highlight=False)
    elif any(np.isfinite(one.error) for one in found):
        console.print(OF_MOTION if plan.motion else "±: the estimated error of the value", highlight=False)


def write_tables(plan: SweepPlan, rows: Sequence[SweepRow], found: Sequence[Average]) -> None:
    """Write sweep.csv, a row for each point and quantity, and runs.csv, a row for each run.

    Numbers have all their digits, and what is not there is empty. Raises InputError.
    """
    keys = [key.name for key in plan.keys]
    means = [
        [
            *map(value_text, one.point.values()),
            one.quantity,
            *(_number(getattr(one, name)) for name in _NUMBERS),
        ]
        for one in found
    ]
    write_whole(plan.folder / TABLE, csv_text([[*keys, "quantity", *_NUMBERS], *means]))
    columns = [*keys, *([SEED] if plan.seeds else []), "folder", "status"]
    columns += [column for name in plan.quantities for column in (name, f"error of {name}")]
    write_whole(plan.folder / RUNS, csv_text([columns, *(_run(plan, row) for row in rows)]))


def _run(plan: SweepPlan, row: SweepRow) -> list[object]:
    folder = os.path.relpath(row.request.folder, plan.folder.absolute())
    known: list[object] = []
    for name in plan.quantities:
        value = row.values.get(name)
        known += ["", ""] if value is None else [value.value, _number(value.error)]
    status = "done" if row.done else f"failed: {row.failure}"
    return [*map(value_text, row.request.values.values()), folder, status, *known]


def _number(value: float | None) -> object:
    return "" if value is None or not np.isfinite(value) else value
