"""The fields that `fsi render --field` can show: each is one entry here, or is registered from elsewhere.

    register_field(
        RenderedField("fast", "|u|^2", "square of the speed", "viridis", Logarithmic(6.0), ("velocity",),
                      lambda at, viscosity: (at["velocity"] ** 2).sum(axis=1))
    )

The command takes its choices and its help from here, and all pictures what they draw. What a value is
computed from is known at points of the flow, by the names of the run's files: `velocity` u, (n, 3);
`pressure` p, (n,); `disturbance` u - u_inf, (n, 3), of sheared flows; `strain_rate` sqrt(2 e:e), (n,);
`vorticity`, (n,), on a plane in space its part across that; on bodies `traction`
sigma n, (n, 3). With an axis, components are those along r and z, and gradients hold the hoop rate u_r / r.

Its scale says how values become colours: the range by how much of the window each value stands for, so that a
film thinner than a pixel does not set the colours of what is seen.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Literal, Self, override

from fsi.errors import InputError, refuse_taken

if TYPE_CHECKING:  # for `fsi render --help`, which lists the fields, what draws them is not imported
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Colormap, Normalize

    from fsi.arrays import Array

type KnownAtPoints = Mapping[str, Array]
type Span = tuple[float, float]

DISTURBANCE = "disturbance"  # velocity less the linear flow without bodies, where there is one
_SLOW = 0.05  # the part of the area with the lowest values, which has one colour
_FEW = 1e-4  # the part with the highest: a hundred pixels of the default size
_KNOWN = 1e-6  # of the largest value: differences below are those of the elements
_LINEAR = 0.03  # part of the largest value up to which the scales of signed fields are linear


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

    @abstractmethod
    def norm(self, span: Span) -> Normalize:
        """Values to [0, 1]."""


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
    def norm(self, span: Span) -> Normalize:
        from matplotlib.colors import LogNorm, Normalize

        return LogNorm(*span) if span[0] > 0.0 else Normalize(*span)


class Signed(Scale):
    """For values of both signs: on both sides of zero, to the size that hardly any of the area exceeds.

    On a plane to the largest size. Logarithmic on both sides, linear in between: films hold far larger values
    than others.
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
    def norm(self, span: Span) -> Normalize:
        from matplotlib.colors import SymLogNorm

        return SymLogNorm(_LINEAR * max(map(abs, span)), vmin=span[0], vmax=span[1], base=10)


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
    def norm(self, span: Span) -> Normalize:
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
    def norm(self, span: Span) -> Normalize:
        from matplotlib.colors import Normalize

        return Normalize(*span)


def exceeded(values: Array, weights: Array, part: float) -> float:
    """What is exceeded on that part of the weight, by values (n,) of one sign."""
    order = values.argsort()
    share = weights[order].cumsum()
    return float(values[order][min(share.searchsorted((1.0 - part) * share[-1]), len(order) - 1)])


def shaded(scale: Scale, span: Span, colours: Colormap) -> ScalarMappable:
    """What colours mean; a single one where the ends of the range are equal."""
    from matplotlib.cm import ScalarMappable

    return one_colour(span[0], colours) if span[0] == span[1] else ScalarMappable(scale.norm(span), colours)


def one_colour(value: float, colours: Colormap) -> ScalarMappable:
    """The middle one of the colours, for that value, which is in the middle of the range."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    reach = abs(value) or 1.0
    return ScalarMappable(Normalize(value - reach, value + reach), ListedColormap([colours(0.5)]))


@dataclass(frozen=True)
class RenderedField:
    """A field as pictures show it.

    Attributes:
        name: what `--field` calls it.
        label: what its colour bar says, a formula; {x} and {y} in it are the coordinates of the plane.
        title: what is written above a panel.
        colours: the name of a colour map of matplotlib: perceptual, told apart by every eye, bright where the
            field is large, white at zero where it is signed.
        scale: how values become colours.
        needs: the data that it is computed from.
        value: from these data at n points, and the viscosity, to the field there, (n,).
        pale: whether to leave out the dark end of the colours, so that dark lines stay visible.
        streamlines: the velocity whose streamlines are drawn on it; none: no lines.
        edges: whether to draw those of the cells on it.
        on_bodies: whether it lives on the surfaces of the bodies.
    """

    name: str
    label: str
    title: str
    colours: str
    scale: Scale
    needs: tuple[str, ...]
    value: Callable[[KnownAtPoints, float], Array]
    pale: bool = False
    streamlines: str = ""
    edges: bool = False
    on_bodies: bool = False

    @property
    def of_mesh(self) -> bool:
        """Whether only a level with a mesh has it."""
        return self.edges or "traction" in self.needs

    def along(self, right: str, up: str) -> Self:
        """The same where the coordinates have those letters."""
        return replace(self, label=self.label.replace("{x}", right).replace("{y}", up))

    def shades(self, span: Span) -> ScalarMappable:
        """What its colours mean."""
        return shaded(self.scale, span, self.colour_map)

    @property
    def colour_map(self) -> Colormap:
        """The map of that name."""
        import numpy as np
        from matplotlib import colormaps
        from matplotlib.colors import ListedColormap

        colours = colormaps[self.colours]
        return ListedColormap(colours(np.linspace(0.35, 1.0, 256))) if self.pale else colours


_FIELDS: dict[str, RenderedField] = {}


def register_field(field: RenderedField) -> None:
    """Let `fsi render --field` show it. Raises ValueError: another one, of another file, has its name."""
    if field.name in _FIELDS:
        refuse_taken(field.name, _FIELDS[field.name].value, field.value)
    _FIELDS[field.name] = field


def field_names() -> list[str]:
    """What can be chosen."""
    return [*_FIELDS]


def rendered_field(name: str) -> RenderedField:
    """The field of that name. Raises InputError: there is none."""
    known = field_names()
    if name not in known:
        raise InputError(f"--field {name}: give one of {', '.join(known)}")
    return _FIELDS[name]


for _field in (
    RenderedField("speed", "|u|", "speed and streamlines", "viridis", Logarithmic(4.0),
                  ("velocity",), lambda at, _: (at["velocity"] ** 2).sum(axis=1) ** 0.5,
                  streamlines="velocity"),
    RenderedField("pressure", "p", "pressure", "RdBu_r", Signed(),
                  ("pressure",), lambda at, _: at["pressure"]),
    RenderedField(DISTURBANCE, r"$|u - u_\infty|$", "velocity less the mean flow, its streamlines", "viridis",
                  FromZero(), (DISTURBANCE,), lambda at, _: (at[DISTURBANCE] ** 2).sum(axis=1) ** 0.5,
                  streamlines=DISTURBANCE),
    RenderedField("vorticity", r"$\partial_{x} u_{y} - \partial_{y} u_{x}$", "vorticity", "PuOr_r", Signed(),
                  ("vorticity",), lambda at, _: at["vorticity"]),
    RenderedField("dissipation", r"$2 \mu\, e : e$", "dissipation", "magma", Logarithmic(8.0),
                  ("strain_rate",), lambda at, viscosity: viscosity * at["strain_rate"] ** 2),
    RenderedField("traction", r"$|\sigma n|$", "traction on the bodies", "plasma", Logarithmic(4.0),
                  ("traction",), lambda at, _: (at["traction"] ** 2).sum(axis=1) ** 0.5,
                  on_bodies=True),
    RenderedField("mesh", "p", "pressure and mesh", "cividis", Linear(),
                  ("pressure",), lambda at, _: at["pressure"], pale=True, edges=True),
):  # fmt: skip
    register_field(_field)
