"""The times that steps must land on, and how they are met without a sliver of a step."""

from __future__ import annotations

import math
from dataclasses import dataclass

# A step that ends this close to a stop is stretched to land on it; `limiter.SAFETY` allows for it.
STRETCH = 1.1
# Two times closer than this, relative to the end, are one.
SAME_TIME = 1e-12


@dataclass(frozen=True, slots=True)
class Schedule:
    """Steps land on `knots` (the kinks of the data), on multiples of `interval` (None: none), on the end."""

    end: float
    knots: tuple[float, ...] = ()
    interval: float | None = None

    def next_stop(self, t: float) -> float:
        """The first time after t to land on; at most the end."""
        stops = [*self.knots, *self._outputs_after(t)]
        first = min((s for s in stops if s > t and not self._same(s, t)), default=self.end)
        return self.end if first > self.end or self._same(first, self.end) else first

    def landing(self, t: float, h: float) -> float:
        """Where a step of about h from t ends: never a sliver short of a stop, at most `STRETCH` h long."""
        stop = self.next_stop(t)
        left = stop - t
        if left <= STRETCH * h:
            return stop
        return t + (left / 2.0 if left < 2.0 * h else h)

    def is_output(self, t: float) -> bool:
        """True if fields are written at t: always without an interval, and always at the end."""
        if self.interval is None or t >= self.end:
            return True
        return self._same(t, round(t / self.interval) * self.interval)

    def _outputs_after(self, t: float) -> list[float]:
        """The next multiples of the interval, among them the first after t whatever the rounding."""
        if self.interval is None:
            return []
        count = math.floor(t / self.interval)
        return [k * self.interval for k in (count, count + 1, count + 2)]

    def _same(self, t: float, other: float) -> bool:
        return abs(t - other) <= SAME_TIME * self.end
