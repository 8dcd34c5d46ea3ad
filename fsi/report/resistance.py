"""What `fsi resistance` shows and writes. Loads are EXTERNAL here: the fluid exerts the opposite."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from fsi.bodies.configuration import Array
from fsi.errors import InputError
from fsi.observables.resistance import Resistance

# Two discs; wider tables do not fit on a screen.
LARGEST_TABLE = 6
# Relative to the diagonal, what is below this is an error of the mesh, or little more.
SMALL = 1e-4
NO_MOBILITY = (
    "no mobility: R is singular: no wall is at rest, so that a rigid motion of everything costs nothing"
)


def resistance_json(name: str, found: Resistance, error: float, truncation: float | None) -> dict[str, Any]:
    """The object that `fsi resistance --json` prints; `truncation` is there where it could be measured."""
    mobility = None if found.mobility is None else found.mobility.tolist()
    data: dict[str, Any] = {
        "name": name,
        "loads": list(found.modes.loads),
        "velocities": list(found.modes.velocities),
        "resistance": found.R.tolist(),
        "mobility": mobility,
        "smallest_eigenvalue": float(found.eigenvalues[0]),
        "largest_eigenvalue": float(found.eigenvalues[-1]),
        "error": error,
        "checks": found.checks,
        "dofs": found.dofs,
        "cells": found.cells,
        "seconds": sum(found.seconds.values()),
        "seconds_by_phase": found.seconds,
    }
    return data if truncation is None else data | {"truncation": truncation}


def print_resistance(
    console: Console, name: str, found: Resistance, error: float, truncation: float | None
) -> None:
    """The same for a reader; matrices of more than two discs are left to files."""
    loads, velocities = found.modes.loads, found.modes.velocities
    if len(found.R) > LARGEST_TABLE:
        console.print(Text(f"{name}: {len(found.R)} modes; --output and --json give the matrices"))
    else:
        console.print(Text(f"{name}: resistance R, F = R U, F external"))
        console.print(_matrix(loads, velocities, found.R))
        if found.mobility is not None:
            console.print(Text("mobility, U = R^-1 F"), _matrix(velocities, loads, found.mobility), sep="\n")
    if found.mobility is None:
        console.print(Text(NO_MOBILITY))
    console.print(_checks(found, error, truncation))
    console.print(
        Text(f"{found.cells} cells, {found.dofs} unknowns, {sum(found.seconds.values()):.2f} CPU s")
    )


def _matrix(rows: tuple[str, ...], columns: tuple[str, ...], values: Array) -> Table:
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, padding=(0, 1, 0, 0))
    table.add_column("", no_wrap=True)
    for label in columns:
        table.add_column(label.replace(".", "\n"), justify="right", no_wrap=True)
    size = np.sqrt(np.abs(np.outer(values.diagonal(), values.diagonal())))
    for label, row, scale in zip(rows, values, SMALL * size, strict=True):
        table.add_row(label, *map(_number, row, scale))
    return table


def _number(value: float, small: float) -> str:
    """Four digits, or one where the value is small."""
    return f"{value:.4g}" if abs(value) >= small else f"{value:.0e}"


def _checks(found: Resistance, error: float, truncation: float | None) -> Table:
    table = Table("check, relative, the worst of all columns")
    table.add_column("value", justify="right")
    for name, value in found.checks.items():
        table.add_row(name, f"{value:.1e}")
    table.add_row("estimated error of R_ij over sqrt(R_ii R_jj)", f"{error:.1e}")
    if truncation is not None:
        table.add_row("truncation: change of R when the radius is halved", f"{truncation:.1e}")
    smallest, largest = found.eigenvalues[[0, -1]]
    table.add_section()
    table.add_row("smallest eigenvalue of R, in units of mu and radii", f"{smallest:.4g}")
    table.add_row("largest", f"{largest:.4g}")
    return table


def _csv(data: Mapping[str, Any]) -> bytes:
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["", *data["velocities"]])
    for label, row in zip(data["loads"], data["resistance"], strict=True):
        table.writerow([label, *row])
    return text.getvalue().encode()


def _npz(data: Mapping[str, Any]) -> bytes:
    keys = ["loads", "velocities", "resistance", *(["mobility"] if data["mobility"] else [])]
    file = io.BytesIO()
    np.savez(file, allow_pickle=False, **{key: np.array(data[key]) for key in keys})
    return file.getvalue()


FORMATS: dict[str, Callable[[Mapping[str, Any]], bytes]] = {
    ".json": lambda data: json.dumps(data, indent=1).encode(),
    ".csv": _csv,
    ".npz": _npz,
}


def require_format(path: Path) -> None:
    """Refuse a file that `write_resistance` cannot write. Raises InputError."""
    if path.suffix not in FORMATS:
        raise InputError(f"output = {path}: unknown suffix {path.suffix!r}; give {', '.join(FORMATS)}")


def write_resistance(path: Path, data: Mapping[str, Any]) -> None:
    """Write what `resistance_json` gives: all of it to .json, R and its inverse to .npz, R alone to .csv.

    Raises:
        InputError: the file cannot be written.
    """
    temporary = path.with_name(f".partial-{path.name}")
    try:
        temporary.write_bytes(FORMATS[path.suffix](data))
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"output = {path}: {error.strerror}; give another path") from error
