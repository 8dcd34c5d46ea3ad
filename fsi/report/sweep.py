"""What `fsi sweep` prints, and its tables."""

import csv
import io
import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from rich.console import Console

from fsi.case.section import toml_text
from fsi.files import write_whole
from fsi.report.console import table
from fsi.studies.sweep import SEED, Average, SweepPlan, SweepRow

TABLE, RUNS = "sweep.csv", "runs.csv"
_NUMBERS = ("mean", "standard_error", "deviation", "count", "failed", "error")


def print_averages(console: Console, plan: SweepPlan, found: Sequence[Average]) -> None:
    """A row for each point, a table for each quantity."""
    for quantity in plan.quantities:
        shown = table((), (*(key.name for key in plan.keys), quantity, "±", "deviation", "runs", "failed"))
        for one in (one for one in found if one.quantity == quantity):
            spread = (f"{x:.2g}" if np.isfinite(x) else "" for x in (one.standard_error, one.deviation))
            mean = f"{one.mean:.8g}" if one.count else ""
            shown.add_row(
                *map(_text, one.point.values()), mean, *spread, str(one.count), str(one.failed or "")
            )
        console.print(shown)
    if plan.seeds:
        console.print("±: the standard error of the mean over seeds", highlight=False)


def write_tables(plan: SweepPlan, rows: Sequence[SweepRow], found: Sequence[Average]) -> None:
    """Write sweep.csv, a row for each point and quantity, and runs.csv, a row for each run.

    Numbers have all their digits, and what is not there is empty. Raises InputError.
    """
    keys = [key.name for key in plan.keys]
    means = [
        [*map(_text, one.point.values()), one.quantity, *(_number(getattr(one, name)) for name in _NUMBERS)]
        for one in found
    ]
    write_whole(plan.folder / TABLE, _csv([*keys, "quantity", *_NUMBERS], means))
    columns = [*keys, *([SEED] if plan.seeds else []), "folder", "status"]
    columns += [column for name in plan.quantities for column in (name, f"error of {name}")]
    write_whole(plan.folder / RUNS, _csv(columns, [_run(plan, row) for row in rows]))


def _run(plan: SweepPlan, row: SweepRow) -> list[object]:
    folder = os.path.relpath(row.request.folder, plan.folder.absolute())
    known: list[object] = []
    for name in plan.quantities:
        value = None if row.values is None else row.values[name]
        known += ["", ""] if value is None else [value.value, _number(value.error)]
    status = "done" if row.values is not None else f"failed: {row.failure}"
    return [*map(_text, row.request.values.values()), folder, status, *known]


def _csv(header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()


def _number(value: float | None) -> object:
    return "" if value is None or not np.isfinite(value) else value


def _text(value: Any) -> str:
    return value if isinstance(value, str) else toml_text(value)
