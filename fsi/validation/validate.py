"""`fsi validate`, from case files to rows in a folder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import fsi.parallel as parallel
from fsi.errors import InputError, ValidationError
from fsi.validation.rows import Row, chosen_cases, write_rows


def validate_cases(
    folder: Path, names: Sequence[str], output: Path, show: Callable[[list[Row]], None]
) -> list[Row]:
    """Validate the named cases of a folder, or all; collective.

    Args:
        folder: of the case files.
        names: of those that are wanted; none means all.
        output: a new folder, for validation.json, validation.csv and the runs.
        show: is told the rows of each case, or of each value of its sweep.

    Raises:
        InputError: no such case, or the output folder is not new.
    """
    from fsi.validation.resolved import rows_of

    paths = parallel.on_root(lambda: chosen_cases(folder, names))
    parallel.on_root(lambda: _make(output))
    rows: list[Row] = []
    for path in paths:
        for rows_of_case in rows_of(path, output / "runs"):
            rows += rows_of_case
            show(rows_of_case)
    parallel.on_root(lambda: write_rows(rows, output))
    return rows


def require_passed(rows: Sequence[Row]) -> None:
    """Raise ValidationError if a value lies outside its tolerance."""
    failed = [row for row in rows if not row.passed]
    if failed:
        row = failed[0]
        wrong = row.failure or f"= {row.value:.9g}, off by {row.true_error:.1e}"
        raise ValidationError(
            f"{len(failed)} of {len(rows)} rows fail, first {row.case}: {row.quantity} {wrong}; expected "
            f"{row.reference:.9g} within {row.rtol:g}"
        )


def _make(output: Path) -> None:
    """A new folder."""
    if output.exists() and not (output.is_dir() and not any(output.iterdir())):
        raise InputError(f"output = {output}: exists and is not empty; give another folder")
    try:
        (output / "runs").mkdir(parents=True)
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror}; give a folder that can be written") from None
