"""How the values of a field become colours: which range they span, and what lies between its ends.

A scale says the range of values by how much of the window each stands for, so that a film thinner than a
pixel does not set the colours of what is seen.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if (
    TYPE_CHECKING
):  # `fsi render --help` lists the fields: what their colours need is imported when they are drawn
    from matplotlib.colors import Normalize

    from fsi.bodies.configuration import Array

type Span = tuple[float, float]

_SLOW = 0.05  # the part of the area with the lowest values, which has one colour
_FEW = 1e-4  # the part with the highest: a hundred pixels of the default size
_LINEAR = 0.03  # part of the largest value up to which the scales of signed fields are linear


class Scale(Protocol):
    """A kind of scale."""

    @property
    def whole(self) -> bool:
        """Whether it spans all values there are; else those beyond both ends have the colours of the ends."""

    def span(self, values: Array, weights: Array) -> Span:
        """The range for values (n,) that stand for areas of those sizes (n,)."""

    def span_on_plane(self, values: Array) -> Span:
        """The range for evenly spaced values (n,), on a plane in space."""

    def norm(self, span: Span) -> Normalize:
        """Values to [0, 1]."""


@dataclass(frozen=True)
class Logarithmic:
    """For values of one sign, from what is exceeded on most of the area to what is on hardly any.

    Attributes:
        decades: the most that differ in colour.
    """

    decades: float
    whole: bool = False

    def span(self, values: Array, weights: Array) -> Span:
        """As the scale says, or a decade where all values are the same."""
        low, largest = exceeded(values, weights, 1.0 - _SLOW), exceeded(values, weights, _FEW)
        low = max(low, 10.0**-self.decades * largest)
        return (low, largest) if low < largest else (0.1 * (largest or 1.0), largest or 1.0)

    def span_on_plane(self, values: Array) -> Span:
        """Half of those decades below the largest value."""
        largest = float(values.max()) or 1.0
        return 10.0 ** (-0.5 * self.decades) * largest, largest

    def norm(self, span: Span) -> Normalize:
        """By the logarithm."""
        from matplotlib.colors import LogNorm

        return LogNorm(*span)


@dataclass(frozen=True)
class Signed:
    """For values of both signs: on both sides of zero, to the size that hardly any of the area exceeds."""

    whole: bool = False

    def span(self, values: Array, weights: Array) -> Span:
        """As the scale says."""
        largest = exceeded(abs(values), weights, _FEW) or 1.0
        return -largest, largest

    def span_on_plane(self, values: Array) -> Span:
        """The largest size, on both sides of zero."""
        largest = float(abs(values).max()) or 1.0
        return -largest, largest

    def norm(self, span: Span) -> Normalize:
        """Logarithmic on both sides of zero, linear in between: films hold far larger values than others."""
        from matplotlib.colors import SymLogNorm

        return SymLogNorm(_LINEAR * max(map(abs, span)), vmin=span[0], vmax=span[1], base=10)


@dataclass(frozen=True)
class Linear:
    """From the least to the largest value at the nodes."""

    whole: bool = True

    def span(self, values: Array, weights: Array) -> Span:  # noqa: ARG002
        """As the scale says."""
        return float(values.min()), float(values.max())

    def span_on_plane(self, values: Array) -> Span:
        """The same."""
        return self.span(values, values)

    def norm(self, span: Span) -> Normalize:
        """In proportion."""
        from matplotlib.colors import Normalize

        return Normalize(*span)


def exceeded(values: Array, weights: Array, part: float) -> float:
    """What is exceeded on that part of the weight, by values (n,) of one sign."""
    order = values.argsort()
    share = weights[order].cumsum()
    return float(values[order][min(share.searchsorted((1.0 - part) * share[-1]), len(order) - 1)])
