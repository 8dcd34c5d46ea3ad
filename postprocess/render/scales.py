"""How values become colours in pictures: ranges by how much of the window each value stands for.

So a film thinner than a pixel does not set the colours of what is seen. The size that half of the window
exceeds, the typical one, says whether colours of both signs are in proportion.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple, override

if TYPE_CHECKING:  # for `fsi render --help`, which lists the fields, what draws them is not imported
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Colormap, Normalize

    from fsi.arrays import Array

type Span = tuple[float, float]

_SLOW = 0.05  # the part of the area with the lowest values, which has one colour
_FEW = 1e-4  # the part with the highest: a hundred pixels of the default size
_KNOWN = 1e-6  # of the largest value: differences below are those of the elements
_APART = 30.0  # the largest value over the typical one, above which colours in proportion would hide that
_NOISE = 1e-3  # of the largest value: sizes below may be errors of the elements


class Shown(NamedTuple):
    """What a step shows of a field.

    Attributes:
        span: the range of its values, as its scale has it.
        typical: the size that half of the window exceeds.
    """

    span: Span
    typical: float


class Scale(ABC):
    """A kind of scale.

    Attributes:
        whole: whether it spans all values.
        rims: thousandths of the window that lines around bodies are wide, as its middle is as pale as they.
        cut: at which ends of it others have the colour of the end.
    """

    whole: ClassVar[bool] = False
    rims: ClassVar[float] = 0.0
    cut: ClassVar[Literal["neither", "both", "max"]] = "both"

    @abstractmethod
    def span(self, values: Array, weights: Array) -> Span:
        """The range for values (n,) that stand for areas of those sizes (n,); its ends may be equal."""

    @abstractmethod
    def span_on_plane(self, values: Array) -> Span:
        """The range for evenly spaced values (n,), on a plane in space."""

    def joined(self, spans: Sequence[Span]) -> Span:
        """The range of all steps; its ends are equal where it is below what a field is known to.

        Steps where all is zero do not count where others have more and not all values are spanned.
        """
        low, high = zip(*([span for span in spans if self.whole or any(span)] or spans), strict=True)
        least, most = min(low), max(high)
        middle = 0.5 * (least + most)
        return (middle, middle) if most - least <= _KNOWN * max(-least, most) else (least, most)

    def seen(self, values: Array, weights: Array) -> Shown:
        """Of values (n,) that stand for areas of those sizes (n,)."""
        return Shown(self.span(values, weights), exceeded(abs(values), weights, 0.5))

    def seen_on_plane(self, values: Array) -> Shown:
        """Of evenly spaced values (n,), on a plane in space."""
        import numpy as np

        return Shown(self.span_on_plane(values), float(np.median(abs(values))))

    @abstractmethod
    def norm(self, span: Span, typical: float) -> Normalize:
        """Values to [0, 1], where half of the window exceeds the typical size."""


@dataclass(frozen=True)
class Logarithmic(Scale):
    """For values of one sign: from what is exceeded on most of the area to what is on hardly any.

    On a plane half the decades below the largest value. A range that is asked for and begins at 0 or below
    has colours in proportion.

    Attributes:
        decades: the most that differ in colour.
    """

    decades: float

    @override
    def span(self, values: Array, weights: Array) -> Span:
        low, largest = exceeded(values, weights, 1.0 - _SLOW), exceeded(values, weights, _FEW)
        return max(low, 10.0**-self.decades * largest), largest

    @override
    def span_on_plane(self, values: Array) -> Span:
        largest = float(values.max())
        return 10.0 ** (-0.5 * self.decades) * largest, largest

    @override
    def norm(self, span: Span, typical: float) -> Normalize:
        from matplotlib.colors import LogNorm, Normalize

        return LogNorm(*span) if span[0] > 0.0 else Normalize(*span)


class Signed(Scale):
    """For values of both signs: on both sides of zero, to the size that hardly any of the area exceeds.

    On a plane to the largest size. In proportion, unless films hold values decades above the typical size:
    then up to that, which is at least the noise of the elements, and logarithmic on both sides.
    """

    rims = 3.0

    @override
    def span(self, values: Array, weights: Array) -> Span:
        largest = exceeded(abs(values), weights, _FEW)
        return -largest, largest

    @override
    def span_on_plane(self, values: Array) -> Span:
        largest = float(abs(values).max())
        return -largest, largest

    @override
    def norm(self, span: Span, typical: float) -> Normalize:
        from matplotlib.colors import Normalize, SymLogNorm

        largest = max(map(abs, span))
        if largest <= _APART * typical:
            return Normalize(*span)
        return SymLogNorm(max(typical, _NOISE * largest), vmin=span[0], vmax=span[1], base=10)


class Linear(Scale):
    """From the least to the largest value at the nodes, in proportion."""

    whole = True
    cut = "neither"

    @override
    def span(self, values: Array, weights: Array) -> Span:
        return float(values.min()), float(values.max())

    @override
    def span_on_plane(self, values: Array) -> Span:
        return self.span(values, values)

    @override
    def norm(self, span: Span, typical: float) -> Normalize:
        from matplotlib.colors import Normalize

        return Normalize(*span)


class FromZero(Scale):
    """For sizes, in proportion: from zero to what hardly any area exceeds; on a plane to the largest."""

    cut = "max"

    @override
    def span(self, values: Array, weights: Array) -> Span:
        return 0.0, exceeded(values, weights, _FEW)

    @override
    def span_on_plane(self, values: Array) -> Span:
        return 0.0, float(values.max())

    @override
    def norm(self, span: Span, typical: float) -> Normalize:
        from matplotlib.colors import Normalize

        return Normalize(*span)


def exceeded(values: Array, weights: Array, part: float) -> float:
    """What is exceeded on that part of the weight, by values (n,) of one sign."""
    order = values.argsort()
    share = weights[order].cumsum()
    return float(values[order][min(share.searchsorted((1.0 - part) * share[-1]), len(order) - 1)])


def shaded(scale: Scale, seen: Shown, colours: Colormap) -> ScalarMappable:
    """What colours mean; a single one where the ends of the range are equal."""
    from matplotlib.cm import ScalarMappable

    low, high = seen.span
    return one_colour(low, colours) if low == high else ScalarMappable(scale.norm(*seen), colours)


def one_colour(value: float, colours: Colormap) -> ScalarMappable:
    """The middle one of the colours, for that value, which is in the middle of the range."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    reach = abs(value) or 1.0
    return ScalarMappable(Normalize(value - reach, value + reach), ListedColormap([colours(0.5)]))
