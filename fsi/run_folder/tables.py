"""The rows that a step adds to steps.csv and bodies.csv."""

from collections.abc import Sequence

import numpy as np

from fsi.bodies.configuration import LOADS, MODES, PLACES
from fsi.integration.state import StepRecord

STEP_COLUMNS = ("step", "t", "h", "smallest_gap", "rejected")


def step_table(record: StepRecord) -> tuple[list[str], list[list[object]]]:
    """Header and the row of steps.csv, CPU seconds last."""
    columns = dict(sorted(record.columns.items(), key=lambda column: column[0].startswith("cpu_")))
    own: list[object] = [record.step, record.t, record.h, record.smallest_gap, record.rejected]
    return [*STEP_COLUMNS, *columns], [own + [_plain(value) for value in columns.values()]]


def body_table(record: StepRecord, names: Sequence[str]) -> tuple[list[str], list[list[object]]]:
    """Header and rows of bodies.csv."""
    d = record.q.dimension
    more = record.body_columns
    numbers = np.column_stack([record.q.centres, record.q.angles, record.U, record.F, *more.values()])
    listed = numbers.tolist() if names else []  # without names the bodies of this step are not wanted
    rows = [[record.step, record.t, name, *row] for name, row in zip(names, listed, strict=True)]
    return ["step", "t", "body", *PLACES[d], *MODES[d], *LOADS[d], *more], rows


def _plain(value: float) -> float:
    """A NumPy scalar as Python's int or float."""
    return value.item() if isinstance(value, np.generic) else value
