"""How the values of a field become colours: which range they span, and what lies between its ends.

A scale says the range of values by how much of the window each stands for, so that a film thinner than a
pixel does not set the colours of what is seen.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, override

if TYPE_CHECKING:  # for `fsi render --help`, which lists the fields, what draws them is not imported
    from matplotlib.colors import Normalize

    from fsi.bodies.configuration import Array

type Span = tuple[float, float]

_SLOW = 0.05  # the part of the area with the lowest values, which has one colour
_FEW = 1e-4  # the part with the highest: a hundred pixels of the default size
_LINEAR = 0.03  # part of the largest value up to which the scales of signed fields are linear


class Scale(ABC):
    """A kind of scale.

    Attributes:
        whole: whether it spans all values; else those beyond both ends have the colours of the ends.
    """

    whole: ClassVar[bool] = False

    @abstractmethod
    def span(self, values: Array, weights: Array) -> Span:
        """The range for values (n,) that stand for areas of those sizes (n,)."""

    @abstractmethod
    def span_on_plane(self, values: Array) -> Span:
        """The range for evenly spaced values (n,), on a plane in space."""

    @abstractmethod
    def norm(self, span: Span) -> Normalize:
        """Values to [0, 1]."""


@dataclass(frozen=True)
class Logarithmic(Scale):
    """For values of one sign: from what is exceeded on most of the area to what is on hardly any.

    A decade where all values are the same; on a plane half the decades below the largest value.

    Attributes:
        decades: the most that differ in colour.
    """

    decades: float

    @override
    def span(self, values: Array, weights: Array) -> Span:
        low, largest = exceeded(values, weights, 1.0 - _SLOW), exceeded(values, weights, _FEW)
        low = max(low, 10.0**-self.decades * largest)
        return (low, largest) if low < largest else (0.1 * (largest or 1.0), largest or 1.0)

    @override
    def span_on_plane(self, values: Array) -> Span:
        largest = float(values.max()) or 1.0
        return 10.0 ** (-0.5 * self.decades) * largest, largest

    @override
    def norm(self, span: Span) -> Normalize:
        from matplotlib.colors import LogNorm

        return LogNorm(*span)


class Signed(Scale):
    """For values of both signs: on both sides of zero, to the size that hardly any of the area exceeds.

    On a plane to the largest size. Logarithmic on both sides, linear in between: films hold far larger values
    than others.
    """

    @override
    def span(self, values: Array, weights: Array) -> Span:
        largest = exceeded(abs(values), weights, _FEW) or 1.0
        return -largest, largest

    @override
    def span_on_plane(self, values: Array) -> Span:
        largest = float(abs(values).max()) or 1.0
        return -largest, largest

    @override
    def norm(self, span: Span) -> Normalize:
        from matplotlib.colors import SymLogNorm

        return SymLogNorm(_LINEAR * max(map(abs, span)), vmin=span[0], vmax=span[1], base=10)


class Linear(Scale):
    """From the least to the largest value at the nodes, in proportion."""

    whole = True

    @override
    def span(self, values: Array, weights: Array) -> Span:
        return float(values.min()), float(values.max())

    @override
    def span_on_plane(self, values: Array) -> Span:
        return self.span(values, values)

    @override
    def norm(self, span: Span) -> Normalize:
        from matplotlib.colors import Normalize

        return Normalize(*span)


def exceeded(values: Array, weights: Array, part: float) -> float:
    """What is exceeded on that part of the weight, by values (n,) of one sign."""
    order = values.argsort()
    share = weights[order].cumsum()
    return float(values[order][min(share.searchsorted((1.0 - part) * share[-1]), len(order) - 1)])
