"""What `fsi resistance` shows and writes. Loads are EXTERNAL here: the fluid exerts the opposite."""

import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from fsi.arrays import Array
from fsi.errors import InputError
from fsi.files import csv_text, json_text, replace
from fsi.observables.resistance import Resistance, ResistanceErrors
from fsi.report.console import checks_table, print_mesh_instead, table

# Two discs; wider tables do not fit on a screen.
LARGEST_TABLE = 6
# Relative to the diagonal, what is below this is an error of the mesh, or little more.
SMALL = 1e-4
WHY_SINGULAR = "no wall is at rest, so that a rigid motion of everything costs nothing"


def resistance_json(
    name: str, resistance: Resistance, errors: ResistanceErrors, truncation: float | None
) -> dict[str, Any]:
    """The object that `fsi resistance --json` prints; `truncation` is there where it could be measured."""
    data: dict[str, Any] = {
        "name": name,
        "loads": list(resistance.modes.loads),
        "velocities": list(resistance.modes.velocities),
        "resistance": resistance.R.tolist(),
        "resistance_error": errors.R.tolist(),
        "mobility": None if resistance.mobility is None else resistance.mobility.tolist(),
        "mobility_error": None if errors.mobility is None else errors.mobility.tolist(),
        "smallest_eigenvalue": float(resistance.eigenvalues[0]),
        "largest_eigenvalue": float(resistance.eigenvalues[-1]),
        "error": errors.largest,
        "checks": resistance.checks,
        "dofs": resistance.dofs,
        "cells": resistance.pieces,
        "seconds": sum(resistance.seconds.values()),
        "seconds_by_phase": resistance.seconds,
    }
    if resistance.mesh_instead:
        data["mesh_instead"] = resistance.mesh_instead
    return data if truncation is None else data | {"truncation": truncation}


def print_resistance(
    console: Console, name: str, resistance: Resistance, errors: ResistanceErrors, truncation: float | None
) -> None:
    """The same for a reader; matrices of more than two discs are left to files."""
    loads, velocities = resistance.modes.loads, resistance.modes.velocities
    if len(resistance.R) > LARGEST_TABLE:
        console.print(Text(f"{name}: {len(resistance.R)} modes; --output and --json give the matrices"))
    else:
        console.print(Text(f"{name}: resistance R, F = R U, F external"))
        console.print(_matrix(loads, velocities, resistance.R))
        console.print(Text("its errors"), _bars(loads, velocities, errors.R), sep="\n")
        if resistance.mobility is not None:
            console.print(Text("mobility, U = R^-1 F"))
            console.print(_matrix(velocities, loads, resistance.mobility))
        if errors.mobility is not None:
            console.print(Text("its errors"), _bars(velocities, loads, errors.mobility), sep="\n")
    if resistance.mobility is None:
        console.print(Text(f"no mobility: R is singular: {WHY_SINGULAR}"))
    console.print(_checks(resistance, errors.largest, truncation))
    seconds = sum(resistance.seconds.values())
    size = f"{resistance.pieces} {resistance.kind}, {resistance.dofs} unknowns"
    console.print(Text(f"{size}, {seconds:.2f} CPU s"))
    print_mesh_instead(console, resistance.mesh_instead)


def _matrix(rows: tuple[str, ...], columns: tuple[str, ...], values: Array) -> Table:
    size = np.sqrt(np.abs(np.outer(values.diagonal(), values.diagonal())))
    labelled = zip(rows, values, SMALL * size, strict=True)
    return _labelled(columns, ((label, *map(_number, row, scale)) for label, row, scale in labelled))


def _bars(rows: tuple[str, ...], columns: tuple[str, ...], errors: Array) -> Table:
    entries = zip(rows, errors, strict=True)
    return _labelled(columns, ((label, *(f"{error:.0e}" for error in row)) for label, row in entries))


def _labelled(columns: tuple[str, ...], entries: Iterable[Sequence[str]]) -> Table:
    shown = table(("",), [label.replace(".", "\n") for label in columns], entries, box=box.SIMPLE_HEAD)
    shown.show_edge, shown.padding = False, (0, 1, 0, 0)
    return shown


def _number(value: float, small: float) -> str:
    return f"{value:.4g}" if abs(value) >= small else f"{value:.0e}"


def _checks(resistance: Resistance, error: float, truncation: float | None) -> Table:
    checks = resistance.checks | {"estimated error of R_ij over sqrt(R_ii R_jj)": error}
    if truncation is not None:
        checks |= {"truncation: change of R when the radius is halved": truncation}
    shown = checks_table("check, relative, the worst of all columns", checks)
    shown.add_section()
    smallest, largest = resistance.eigenvalues[[0, -1]]
    shown.add_row("smallest eigenvalue of R, in units of mu and radii", f"{smallest:.4g}")
    shown.add_row("largest", f"{largest:.4g}")
    return shown


def _csv(data: Mapping[str, Any]) -> bytes:
    rows = ([label, *row] for label, row in zip(data["loads"], data["resistance"], strict=True))
    return csv_text([["", *data["velocities"]], *rows]).encode()


def _npz(data: Mapping[str, Any]) -> bytes:
    keys = ["loads", "velocities", "resistance", "resistance_error"]
    keys += [key for key in ("mobility", "mobility_error") if data[key] is not None]
    file = io.BytesIO()
    np.savez(file, allow_pickle=False, **{key: np.array(data[key]) for key in keys})
    return file.getvalue()


FORMATS: dict[str, Callable[[Mapping[str, Any]], bytes]] = {
    ".json": lambda data: json_text(data, indent=1).encode(),
    ".csv": _csv,
    ".npz": _npz,
}


def require_format(path: Path) -> None:
    """Refuse a file that `write_resistance` cannot write. Raises InputError."""
    if path.suffix not in FORMATS:
        raise InputError(f"output = {path}: unknown suffix {path.suffix!r}; give {', '.join(FORMATS)}")


def write_resistance(path: Path, data: Mapping[str, Any]) -> None:
    """Write what `resistance_json` gives, .npz R, its inverse and errors, .csv R alone. Raises InputError."""
    try:
        replace(path, FORMATS[path.suffix](data))
    except OSError as error:
        raise InputError(f"output = {path}: {error.strerror}; give another path") from error
