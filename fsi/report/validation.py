"""What `fsi validate` shows: the table of all rows, and the comparison with the law of lubrication."""

from __future__ import annotations

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from fsi.report.console import table
from fsi.validation.rows import Record, Row, sphere_records

WIDTH = 100  # below it the numbers would be folded


def print_errors(console: Console, rows: Sequence[Row]) -> None:
    """One line as soon as a case is computed."""
    worst = max(row.true_error for row in rows)
    console.print(f"{rows[0].case}: gap/a {rows[0].gap:.3g}, error {worst:.1e}", highlight=False)


def print_rows(console: Console, rows: Sequence[Row]) -> None:
    """The table of all rows, the sphere's, and what they come to."""
    console.width = max(console.width, WIDTH)
    console.print(_table(rows))
    for case in dict.fromkeys(row.case for row in rows):
        console.print(*dict.fromkeys(f"{case}: {row.source}" for row in rows if row.case == case), sep="\n")
    for row in rows:
        if row.failure:
            console.print(f"{row.case}: {row.failure}", style="red")
    records = sphere_records(rows)
    if records:
        console.print(_sphere_table(records))
    console.print(summary(rows))


def summary(rows: Sequence[Row]) -> str:
    """How many rows pass, and how many error bars hold."""
    passed = sum(row.passed for row in rows)
    known = [row.bar_holds for row in rows if row.bar_holds is not None and not row.failure]
    text = f"{passed} of {len(rows)} rows pass; "
    if known:
        text += (
            f"{sum(known)} of {len(known)} error bars ({100.0 * sum(known) / len(known):.0f} %) bracket the "
            "true error and are within a factor 10 of it"
        )
    unknown = len(rows) - len(known) - sum(bool(row.failure) for row in rows)
    return text + (f"; {unknown} more agree to all digits of the reference" if unknown else "")


def _sphere_table(records: Sequence[Record]) -> Table:
    case, *numbers = records[0]
    rows = (
        [f"{value:.8g}" if isinstance(value, float) else str(value) for value in record.values()]
        for record in records
    )
    title = "a sphere and a plane: the resolved force over 6 pi mu a U (a/q + ln(a/q)/5 + 0.97128)"
    return table((case,), numbers, rows, title=title)


def _table(rows: Sequence[Row]) -> Table:
    numbers = ("gap/a", "resolved", "± est.", "reference", "true", "rtol")
    title = "validation; errors are relative to the reference"
    shown = table(("case, quantity",), numbers, title=title, box=SIMPLE_HEAD, padding=(0, 1))
    shown.add_column("")
    previous = ""
    for row in rows:
        if row.case != previous:
            if previous:
                shown.add_section()
            shown.add_row(f"[bold]{row.case}[/]")
            previous = row.case
        shown.add_row(
            f"  {row.quantity}",
            f"{row.gap:.6g}",
            f"{row.value:.10g}",
            f"{row.error_bar:.1e}",
            f"{row.reference:.10g}",
            f"{row.true_error:.1e}" if row.true_error > row.digits else f"< {row.digits:.0e}",
            f"{row.rtol:.0e}",
            "[green]ok[/]" if row.passed else "[red]FAIL[/]",
        )
    return shown
