"""Numbers in time that may jump: linear between given times, a time given twice is a jump."""

from __future__ import annotations

import itertools
from typing import Annotated, Any

import numpy as np
from pydantic import Discriminator, Field, Tag, field_validator, model_validator
from scipy.interpolate import PPoly

from fsi.case.section import Section


class Jumping(Section):
    """Values at given times."""

    times: tuple[float, ...] = Field(
        min_length=1, description="the times of the table, not decreasing; a time given twice is a jump"
    )
    values: tuple[float, ...] = Field(description="one value for each time of the table")

    @field_validator("times")
    @classmethod
    def _in_order(cls, times: tuple[float, ...]) -> tuple[float, ...]:
        for before, after in itertools.pairwise(times):
            if after < before:
                raise ValueError(f"must not decrease, but {after!r} follows {before!r}")
        if any(times.count(time) > 2 for time in times):
            raise ValueError("a time may be given twice, before and after a jump, not more often")
        return times

    @model_validator(mode="after")
    def _paired(self) -> Jumping:
        if len(self.times) != len(self.values):
            raise ValueError(f"has {len(self.times)} times but {len(self.values)} values")
        return self


def _kind(value: Any) -> str:
    return "<table>" if isinstance(value, dict | Jumping) else "<number>"


History = Annotated[
    Annotated[float, Tag("<number>")] | Annotated[Jumping, Tag("<table>")], Discriminator(_kind)
]


def polynomial(history: float | Jumping, end: float) -> PPoly:
    """The history on [0, end] as a piecewise polynomial."""
    if not isinstance(history, Jumping):
        return PPoly(np.array([[0.0], [history]]), np.array([0.0, end]))
    times, values = np.array(history.times), np.array(history.values)
    # Long constant ends make one table of it all.
    times = np.concatenate([[min(times[0], 0.0) - 1.0], times, [max(times[-1], end) + 1.0]])
    values = np.concatenate([values[:1], values, values[-1:]])
    pieces = np.diff(times) > 0.0
    left, width = times[:-1][pieces], np.diff(times)[pieces]
    slope = np.diff(values)[pieces] / width
    whole = PPoly(np.array([slope, values[:-1][pieces]]), np.append(left, times[-1]))
    breaks = np.unique(np.concatenate([[0.0, end], left[(left > 0.0) & (left < end)]]))
    starts = breaks[:-1]
    return PPoly(np.array([whole.derivative()(starts), whole(starts)]), breaks)
