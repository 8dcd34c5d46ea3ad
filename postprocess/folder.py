"""A run folder as its readers see it: the case and the tables."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from fsi.bodies import Array
from fsi.case import Case, load_case
from fsi.errors import InputError


def read_case(run: Path) -> Case:
    """The resolved case of a run. Raises InputError when `run` is not a run folder."""
    path = run / "case.toml"
    if not path.is_file():
        raise InputError(f"run = {run}: there is no case.toml; give the folder that `fsi run` has written")
    return load_case(path)


def read_table(path: Path) -> dict[str, Array]:
    """The numeric columns of a table of the run, each of shape (rows,). Raises InputError."""
    try:
        with path.open(newline="") as lines:
            rows = list(csv.DictReader(lines))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; give a folder that `fsi run` has written") from None
    if not rows:
        raise InputError(f"{path}: the table has no rows yet; continue the run with `fsi resume`")
    try:
        return {name: np.array([float(row[name]) for row in rows]) for name in rows[0] if name != "body"}
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: a row is broken ({error}); mend it with `fsi resume`") from None
