"""The tables of a run folder, as far as they are complete; refused where someone has changed them."""

import io
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from fsi.errors import InputError
from fsi.files import content

# What is not a number at instants to which it does not apply.
_VISCOSITIES = ("apparent_viscosity", "err_apparent_viscosity", "lubrication_viscosity", "viscosity_bound")
_SOMETIMES = (*_VISCOSITIES, "stress", "err_dissipation")
# What the tables of all models begin with.
_STEPS = ("step", "t")


def read_table(path: Path, length: int | None) -> pd.DataFrame:
    """The first `length` bytes of a CSV file, all of it if None.

    Raises InputError: there is no such file, it has no rows, or (steps.csv, bodies.csv) it is not as a run
    has written it.
    """
    text = content(path, "give a folder that `fsi run` has written")
    if length is not None and len(text) < length:
        raise _changed(path, f"{length - len(text)} bytes are missing at its end")
    text = text[:length]
    try:
        frame = pd.read_csv(io.BytesIO(text)) if text.strip() else pd.DataFrame()
    except ValueError as error:
        raise _changed(path, " ".join(str(error).split())) from None
    if frame.empty and path.stem != "contacts":  # there may be none
        raise InputError(f"{path}: the table has no rows yet; continue the run with `fsi resume`")
    if path.stem == "steps":
        _require_numbers(path, frame, _STEPS)
    elif path.stem == "bodies":
        _require_numbers(path, frame, (*_STEPS, "body", *("xyz" if "z" in frame else "xy")))
        if frame["step"].value_counts().nunique() > 1:
            raise _changed(path, "its steps have different numbers of bodies")
    return frame


def rows_of(table: pd.DataFrame, step: int) -> pd.DataFrame:
    """Those of a step. Raises InputError: there are none."""
    rows = table.loc[table["step"] == step]
    if rows.empty:
        raise InputError(f"step = {step}: is not there, the last is {table['step'].iloc[-1]}; give another")
    return rows


def spread(rows: int, most: int) -> NDArray[np.intp]:
    """Positions of at most so many rows, evenly spread, first and last included."""
    return np.unique(np.linspace(0, rows - 1, most).astype(np.intp)) if rows else np.empty(0, dtype=np.intp)


def _require_numbers(path: Path, frame: pd.DataFrame, columns: tuple[str, ...]) -> None:
    """These columns come first; all but the names of bodies and what is known sometimes have numbers."""
    for column, wanted in zip(frame.columns, columns, strict=False):
        if column != wanted:
            raise _changed(path, f'a column is "{column}" where "{wanted}" stood')
    if len(frame.columns) < len(columns):
        raise _changed(path, f'its column "{columns[len(frame.columns)]}" is missing')
    numbers = frame.drop(columns="body", errors="ignore")
    for name, values in numbers.items():
        broken = pd.to_numeric(values, errors="coerce").isna()
        if name in _SOMETIMES:
            broken &= values.notna()
        if broken.any():
            row = int(broken.argmax())
            value = f'{name} = "{str(values.iloc[row])[:30]}"'
            raise _changed(path, f"{value} in its row {row + 1} is not a number")


def _changed(path: Path, how: str) -> InputError:
    return InputError(f"{path}: was changed since the run wrote it ({how}); run the case again")
