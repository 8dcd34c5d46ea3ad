"""One case for all combinations of values of its keys, each with several seeds: `fsi sweep`.

Each run has a folder of its own with its case and, once it is done, its result, so that a sweep that was
broken off goes on when it is repeated, and may be repeated with more values, seeds or quantities.
"""

import itertools
import re
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fsi.case.load import case_data, parse_case
from fsi.case.section import toml_text
from fsi.errors import InputError
from fsi.studies.evaluate import FoundValue, require_quantity
from fsi.studies.keys import require_apart
from fsi.studies.member import Request

SEED = "arrangement.seed"
_LONGEST = 100  # letters of the name of a folder


@dataclass(frozen=True, slots=True)
class SweptKey:
    """A dotted key of the case and its values."""

    name: str
    values: Sequence[Any]


def value_text(value: Any) -> str:
    """A value in tables and pictures: words have no quotes."""
    return value if isinstance(value, str) else toml_text(value)


@dataclass(frozen=True, slots=True)
class SweepPlan:
    """What is run.

    Attributes:
        case: the case file.
        overrides: changes of it, `key=value`.
        keys: those that vary; all combinations of their values are run.
        seeds: each with so many seeds, 1, 2, ...; 0 for the seed of the case.
        quantities: by the names of [[expected]] rows.
        motion: whether each case is run to its end, or solved at time 0.
        folder: where the folders of all runs are.
    """

    case: Path
    overrides: Sequence[str]
    keys: Sequence[SweptKey]
    seeds: int
    quantities: Sequence[str]
    motion: bool
    folder: Path

    @property
    def averaged(self) -> bool:
        """Whether a point has several runs, which differ; else what is known is the error bar of its one."""
        return self.seeds > 1

    def points(self) -> list[dict[str, Any]]:
        """All combinations of values by their keys; the first key varies slowest."""
        names = [key.name for key in self.keys]
        return [
            dict(zip(names, values, strict=True))
            for values in itertools.product(*(k.values for k in self.keys))
        ]

    def requests(self) -> list[Request]:
        """What is run, in the order of the tables: all seeds of the first point, and on.

        Raises InputError: a key has its values twice, or the case is not sound for the first seed of some
        point, or lacks a quantity.
        """
        self._require_apart()
        found = [self._request(values) for point in self.points() for values in self._seeded(point)]
        for request in found[:: max(self.seeds, 1)]:
            try:
                case = parse_case(request.case)
            except InputError as error:
                raise InputError(_blamed(request.values, str(error))) from None
            if not self.motion and not case.level.viscous:
                raise InputError(f'model = "{case.model}": has no velocities at an instant; add --run')
            if self.motion:
                _ = case.timing
            for quantity in self.quantities:
                require_quantity(case, quantity, moving=self.motion)
        return found

    def _require_apart(self) -> None:
        """Raise InputError where a key that varies is changed from elsewhere too."""
        names = [key.name for key in self.keys]
        if self.seeds and SEED in names:
            raise InputError(f"--vary {SEED}: --seeds {self.seeds} gives its values too; drop one of them")
        require_apart(names, self.overrides)
        if self.seeds:
            require_apart([SEED], self.overrides)

    def _seeded(self, point: Mapping[str, Any]) -> list[dict[str, Any]]:
        return [{**point, SEED: 1 + k} for k in range(self.seeds)] if self.seeds else [dict(point)]

    def _request(self, values: Mapping[str, Any]) -> Request:
        data = case_data(self.case, self.overrides, values)
        folder = self.folder.absolute() / "runs" / _slug(values)
        return Request(folder, values, data, tuple(self.quantities), self.motion)


@dataclass(frozen=True, slots=True)
class Average:
    """A quantity at one point, over the seeds that have it.

    Attributes:
        point: values of the keys.
        quantity: its name.
        mean: over the runs that were done, NaN without any.
        standard_error: of the mean, the deviation over the root of the count; NaN of fewer than two.
        deviation: of one run, with count - 1 in the denominator; NaN of fewer than two.
        count: how many were done.
        failed: how many were not.
        error: the largest error bar of any run, NaN where there is none.
    """

    point: Mapping[str, Any]
    quantity: str
    mean: float
    standard_error: float
    deviation: float
    count: int
    failed: int
    error: float


@dataclass(frozen=True, slots=True)
class SweepRow:
    """A run of a sweep: what was asked, which quantities came of it, and why not all did."""

    request: Request
    values: Mapping[str, FoundValue]
    failure: str = ""

    @property
    def done(self) -> bool:
        """Whether it has all that was asked for."""
        return len(self.values) == len(self.request.quantities)


def averages(plan: SweepPlan, rows: Sequence[SweepRow]) -> list[Average]:
    """One for each point and quantity, in the order of the plan; the rows are those of its requests."""
    groups = itertools.batched(rows, max(plan.seeds, 1))
    pairs = [(point, group) for point, group in zip(plan.points(), groups, strict=True)]
    return [_average(point, name, group) for name in plan.quantities for point, group in pairs]


def _average(point: Mapping[str, Any], quantity: str, rows: Sequence[SweepRow]) -> Average:
    found = [row.values[quantity] for row in rows if quantity in row.values]
    x, n = np.array([one.value for one in found]), len(found)
    deviation = float(x.std(ddof=1)) if n > 1 else np.nan
    bars = [one.error for one in found if one.error is not None]
    mean = float(x.mean()) if n else np.nan
    failed = len(rows) - n
    return Average(
        point, quantity, mean, deviation / np.sqrt(n or 1), deviation, n, failed, max(bars, default=np.nan)
    )


def _blamed(values: Mapping[str, Any], said: str) -> str:
    """What is wrong, with the values with which it is, unless it names one of their keys itself."""
    if not values or any(said.startswith(key) for key in values):
        return said
    return f"{', '.join(f'{key} = {toml_text(value)}' for key, value in values.items())}: {said}"


def _slug(values: Mapping[str, Any]) -> str:
    """The name of the folder of a run: its values, as far as they may stand in one."""
    text = ",".join(f"{key}={toml_text(value)}" for key, value in values.items())
    plain = re.sub(r"[^\w.=,+-]+", "_", text.replace('"', ""))
    if plain == text and len(text) <= _LONGEST:
        return text
    whole = ",".join(f"{key}={value!r}" for key, value in values.items())
    return f"{plain[:_LONGEST]}-{zlib.crc32(whole.encode()):08x}"
