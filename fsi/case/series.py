"""Numbers that may depend on time: a constant, or a table with linear interpolation, perhaps with jumps."""

import itertools
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag, field_validator, model_validator

from fsi.case.section import Section

if TYPE_CHECKING:
    import scipy


def _increasing(values: tuple[float, ...]) -> tuple[float, ...]:
    for before, after in itertools.pairwise(values):
        if not before < after:
            raise ValueError(f"must increase, but {after!r} follows {before!r}")
    return values


Increasing = Annotated[tuple[float, ...], AfterValidator(_increasing)]


def require_pairs(**columns: tuple[float, ...]) -> None:
    """Raise ValueError where two columns of a table, given by name, are not equally long."""
    (one, first), (other, second) = columns.items()
    if len(first) != len(second):
        raise ValueError(f"has {len(first)} {one} but {len(second)} {other}")


class Table(Section):
    """Values at given times, linear between them, constant before the first and after the last.

    A time that stands twice is a jump. Models whose steps take the integral of a load allow it (gluey and
    macroscopic); the others want a steep ramp.
    """

    times: tuple[float, ...] = Field(min_length=1)
    """the times of the table, not decreasing; a time given twice is a jump"""
    values: tuple[float, ...]
    """one value for each time of the table"""

    @field_validator("times")
    @classmethod
    def _in_order(cls, times: tuple[float, ...]) -> tuple[float, ...]:
        for before, after in itertools.pairwise(times):
            if after < before:
                raise ValueError(f"must not decrease, but {after!r} follows {before!r}")
        if any(first == third for first, third in zip(times, times[2:], strict=False)):
            raise ValueError("a time may be given twice, before and after a jump, not more often")
        return times

    @model_validator(mode="after")
    def _paired(self) -> Self:
        require_pairs(times=self.times, values=self.values)
        return self


def _series_kind(value: Any) -> str:
    return "<table>" if isinstance(value, dict | Table) else "<number>"


Series = Annotated[
    Annotated[float, Tag("<number>")] | Annotated[Table, Tag("<table>")],
    Discriminator(_series_kind),
]
Component = Annotated[
    Annotated[Literal["free"], Tag("<word>")]
    | Annotated[float, Tag("<number>")]
    | Annotated[Table, Tag("<table>")],
    Discriminator(lambda value: "<word>" if isinstance(value, str) else _series_kind(value)),
]


def _turning_kind(value: Any) -> str:
    return "<vector>" if isinstance(value, list | tuple) else "<scalar>"


# What turns a body: a scalar in the plane, a vector in space.
Angle = Annotated[
    Annotated[float, Tag("<scalar>")] | Annotated[tuple[float, ...], Tag("<vector>")],
    Discriminator(_turning_kind),
]
Torque = Annotated[
    Annotated[Series, Tag("<scalar>")] | Annotated[tuple[Series, ...], Tag("<vector>")],
    Discriminator(_turning_kind),
]
Spin = Annotated[
    Annotated[Component, Tag("<scalar>")] | Annotated[tuple[Component, ...], Tag("<vector>")],
    Discriminator(_turning_kind),
]


def value_at(series: float | Table, t: float) -> float:
    """The value at time t."""
    if isinstance(series, Table):
        return float(np.interp(t, series.times, series.values))
    return series


def kinks(series: float | Table | str) -> tuple[float, ...]:
    """The times at which the value has a kink or jumps; none for a constant."""
    return series.times if isinstance(series, Table) else ()


def jumps(series: float | Table | str) -> tuple[float, ...]:
    """The times at which the value jumps."""
    return tuple(one for one, other in itertools.pairwise(kinks(series)) if one == other)


def polynomial(series: float | Table, end: float) -> "scipy.interpolate.PPoly":
    """The values on [0, end] as a piecewise polynomial: its integrals are exact across kinks and jumps."""
    import scipy  # late: `fsi check` does without

    times, values = map(np.array, _points(series))
    # Long constant ends make one table of it all.
    times = np.concatenate([[min(times[0], 0.0) - 1.0], times, [max(times[-1], end) + 1.0]])
    values = np.concatenate([values[:1], values, values[-1:]])
    pieces = np.diff(times) > 0.0
    left, width = times[:-1][pieces], np.diff(times)[pieces]
    slope = np.diff(values)[pieces] / width
    whole = scipy.interpolate.PPoly(np.array([slope, values[:-1][pieces]]), np.append(left, times[-1]))
    breaks = np.unique(np.concatenate([[0.0, end], left[(left > 0.0) & (left < end)]]))
    starts = breaks[:-1]
    return scipy.interpolate.PPoly(np.array([whole.derivative()(starts), whole(starts)]), breaks)


def is_zero(series: float | Table) -> bool:
    """True when the value is zero at all times."""
    return not any(_points(series)[1])


def _points(series: float | Table) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Times and values; of a constant one of each."""
    return (series.times, series.values) if isinstance(series, Table) else ((0.0,), (series,))
