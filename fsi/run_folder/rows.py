"""The rows of a table as a run writes them; whoever goes on with the run, or reads it, requires the same."""

import csv
import io
from itertools import pairwise
from math import isfinite
from typing import TYPE_CHECKING
from zlib import crc32

from fsi.bodies.configuration import PLACES

if TYPE_CHECKING:
    import pandas as pd

CONTACT_COLUMNS = ("step", "t", "side", "body", "gap", "gamma", "impulse", "solid_impulse")
PROFILE_COLUMNS = ("step", "t", "m", "x", "rho", "u", "gamma")
# What tables begin with, at all levels; that of bodies depends on the dimension.
_BEGINNINGS = {"steps": ("step", "t"), "contacts": CONTACT_COLUMNS, "profiles": PROFILE_COLUMNS}
_BODIES = {d: ("step", "t", "body", *PLACES[d][:d]) for d in (2, 3)}
_WORDS = ("body", "side")
# What is not a number at instants to which it does not apply.
_VISCOSITIES = ("apparent_viscosity", "err_apparent_viscosity", "lubrication_viscosity", "viscosity_bound")
_SOMETIMES = (*_VISCOSITIES, "stress", "err_dissipation")

_LAST_DIGITS = 1e-12  # relative: pandas before 3 may read the last digit of a number as another


def read_rows(table: str, text: bytes, end: float, checksum: int | None = None) -> "pd.DataFrame":
    """The rows of a table (its name without ".csv"), of a run that has come to the time `end`.

    checksum: the CRC-32 of what the run has written, if it is known.

    Raises ValueError unless they are as a run writes them: whole rows under the columns that this table
    begins with, of numbers, in the order of time; in bodies.csv as many for each step; and, last, as it has
    indeed written them.
    """
    import pandas as pd  # takes a fifth of a second to load

    _require_whole(text)
    frame = pd.read_csv(io.BytesIO(text))
    columns = [str(name) for name in frame.columns]
    beginning = _BODIES[3 if "z" in columns else 2] if table == "bodies" else _BEGINNINGS.get(table, ())
    _require_columns(columns, beginning)
    _require_numbers(frame)
    for name in beginning[:2]:
        _require_order(name, frame[name].tolist())
    if beginning and len(frame) and frame["t"].iloc[-1] > end + _LAST_DIGITS * abs(end):
        raise ValueError(f"t = {frame['t'].iloc[-1]} in its last row is after t = {end}, the run's last")
    if table == "bodies" and frame["step"].value_counts().nunique() > 1:
        raise ValueError("its steps have different numbers of bodies")
    if checksum not in (None, crc32(text)):
        raise ValueError("its rows are others than were written")
    return frame


def _require_whole(text: bytes) -> None:
    """Raise ValueError unless all rows have as many cells as the header, and the last one ends."""
    try:
        width = 0
        for place, row in enumerate(csv.reader(io.StringIO(text.decode(), newline=""))):
            width = width or len(row)
            if len(row) != width:
                raise ValueError(f"its row {place} has {len(row)} cells under {width} columns")
    except csv.Error as error:
        raise ValueError(str(error)) from None
    if not text.endswith(b"\n"):
        raise ValueError("its last row does not end")


def _require_columns(columns: list[str], beginning: tuple[str, ...]) -> None:
    """Raise ValueError unless these columns come first."""
    for column, wanted in zip(columns, beginning, strict=False):
        if column != wanted:
            raise ValueError(f'a column is "{column}" where "{wanted}" stood')
    if len(columns) < len(beginning):
        raise ValueError(f'its column "{beginning[len(columns)]}" is missing')


def _require_numbers(frame: "pd.DataFrame") -> None:
    """Raise ValueError unless all but words and what is known sometimes are numbers."""
    import pandas as pd

    for name, values in frame.drop(columns=[*_WORDS], errors="ignore").items():
        broken = pd.to_numeric(values, errors="coerce").isna()
        if name in _SOMETIMES:
            broken &= values.notna()
        if broken.any():
            row = int(broken.argmax())
            value = f'{name} = "{str(values.iloc[row])[:30]}"'
            raise ValueError(f"{value} in its row {row + 1} is not a number")


def _require_order(name: str, values: list[float]) -> None:
    """Raise ValueError unless these are finite and never decrease."""
    for place, value in enumerate(values, start=1):
        if not isfinite(value):
            raise ValueError(f"{name} = {value} in its row {place} is not finite")
    for place, (before, after) in enumerate(pairwise(values), start=2):
        if after < before:
            raise ValueError(f"{name} = {after} in its row {place} comes after {before}")
