"""The tables of a run folder, as far as they are complete; refused where someone has changed them."""

from math import inf
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from fsi.errors import InputError
from fsi.files import content
from fsi.run_folder.kept import REMEDY
from fsi.run_folder.rows import read_rows


def read_table(path: Path, length: int | None, end: float = inf, checksum: int | None = None) -> pd.DataFrame:
    """The first `length` bytes, all if None, of a table of a run that has come to the time `end`.

    checksum: the CRC-32 of these bytes, if it is known.

    Raises InputError: there is no such file, it has no rows, or it is not as a run has written it.
    """
    text = content(path, REMEDY)
    if length is not None and len(text) < length:
        raise _changed(path, f"{length - len(text)} bytes are missing at its end")
    text = text[:length]
    try:
        frame = read_rows(path.stem, text, end, checksum) if text.strip() else pd.DataFrame()
    except ValueError as error:
        raise _changed(path, " ".join(str(error).split())) from None
    if frame.empty and path.stem != "contacts":  # there may be none
        raise InputError(f"{path}: the table has no rows yet; continue the run with `fsi resume`")
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


def _changed(path: Path, how: str) -> InputError:
    return InputError(f"{path}: was changed since the run wrote it ({how}); run the case again")
