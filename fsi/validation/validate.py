"""The command `fsi validate`, from case files to a verdict."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from fsi import parallel
from fsi.errors import InputError, ValidationError
from fsi.report.validation import print_rows, sphere_records
from fsi.validation.rows import Row, chosen_cases, csv_text, write_rows


def validate_cases(folder: Path, names: Sequence[str], output: Path, console: Console) -> None:
    """Validate the named cases of a folder, or all; collective.

    Raises:
        InputError: no such case, or the output folder is not new.
        ValidationError: a value lies outside its tolerance; everything has been written and printed.
    """
    from fsi.validation.resolved import rows_of

    paths = parallel.on_root(lambda: chosen_cases(folder, names))
    parallel.on_root(lambda: _make(output))
    progress = Console(stderr=True, quiet=not parallel.is_root())
    rows: list[Row] = []
    for path in paths:
        for found in rows_of(path, output / "runs"):
            rows += found
            worst = max(row.true_error for row in found)
            progress.print(f"{path.stem}: gap/a {found[0].gap:.3g}, error {worst:.1e}", highlight=False)
    parallel.on_root(lambda: _write(rows, output))
    if parallel.is_root():
        print_rows(console, rows)
        console.print(f"wrote {output}/validation.json, .csv and .png", highlight=False)
    failed = [row for row in rows if not row.passed]
    if failed:
        raise ValidationError(f"{len(failed)} of {len(rows)} rows fail, first {_complaint(failed[0])}")


def _complaint(row: Row) -> str:
    """What is wrong with a row."""
    wrong = row.failure or f"= {row.value:.9g}, off by {row.true_error:.1e}"
    return f"{row.case}: {row.quantity} {wrong}; expected {row.reference:.9g} within {row.rtol:g}"


def _make(output: Path) -> None:
    """A new folder."""
    if output.exists() and not (output.is_dir() and not any(output.iterdir())):
        raise InputError(f"output = {output}: exists and is not empty; give another folder")
    try:
        (output / "runs").mkdir(parents=True)
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror}; give a folder that can be written") from None


def _write(rows: Sequence[Row], output: Path) -> None:
    from fsi.postprocess.plots.validation import plot_rows

    write_rows(rows, output)
    records = sphere_records(rows)
    if records:
        (output / "sphere_wall_ratios.csv").write_text(csv_text(records), encoding="utf-8")
    plot_rows(rows, output / "validation.png")
