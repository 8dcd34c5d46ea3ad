"""What a panel can show: each field with its colours, its scale, and the lines that go with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import Colormap, ListedColormap, LogNorm, Normalize, SymLogNorm

from fsi.bodies.configuration import Array
from fsi.postprocess.choice import Span
from fsi.postprocess.render.curved_cells import edges, nodes, rims, stream_function
from fsi.postprocess.render.panel import INK, Panel, shown, span_in
from fsi.postprocess.render.scenes import Scene

_PALE = ListedColormap(colormaps["cividis"](np.linspace(0.35, 1.0, 256)))  # dark lines stay visible on it
_STREAMLINES = 24
_SLOW = 0.05  # the part of the area with the lowest values, which has one colour
_FEW = 1e-4  # the part with the highest: a hundred pixels of the default size
_DECADES = {"speed": 4.0, "dissipation": 8.0, "traction": 4.0}  # most decades that differ in colour
_LINEAR = 0.03  # part of the largest value up to which the scales of signed fields are linear
_RIBBON = 0.05  # width of the ribbon that shows the traction, in halves of the window


@dataclass(frozen=True)
class Drawing:
    """A field: what its colour bar says, its colours, the range that a scene asks for, its scale."""

    label: str
    title: str
    colours: Colormap
    span: Callable[[Scene], Span]
    norm: Callable[[Span], Normalize]
    draw: Callable[[Panel, Scene, Normalize], None] = field(repr=False)


def _logarithmic(name: str, values: Callable[[Scene], tuple[Array, Array, Array]]) -> Callable[[Scene], Span]:
    """The range from what is exceeded on most of the area to what is on hardly any, at most so many decades.

    A film that is thinner than a pixel does not set the colours of what is seen.
    """

    def span(seen: Scene) -> Span:
        _, value, weight = shown(*values(seen))
        low, largest = _exceeded(value, weight, 1.0 - _SLOW), _exceeded(value, weight, _FEW)
        low = max(low, 10.0 ** -_DECADES[name] * largest)
        return (low, largest) if low < largest else (0.1 * (largest or 1.0), largest or 1.0)

    return span


def _exceeded(value: Array, weight: Array, part: float) -> float:
    """What is exceeded on that part of the weight, by values of one sign."""
    order = np.argsort(value)
    share = np.cumsum(weight[order])
    return float(value[order][min(np.searchsorted(share, (1.0 - part) * share[-1]), len(order) - 1)])


def _in_cells(name: str) -> Callable[[Scene], tuple[Array, Array, Array]]:
    """Middles, mean values and areas of the cells, as if their sides were straight."""

    def values(seen: Scene) -> tuple[Array, Array, Array]:
        cells = nodes(seen.fluid)
        a, b, c = np.asarray(seen.fluid.points)[cells[:, :3].T, :2]
        area = 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
        return (a + b + c) / 3.0, np.asarray(seen.fluid[name])[cells].mean(axis=1), area

    return values


def _on_bodies(seen: Scene) -> tuple[Array, Array, Array]:
    """Points of the bodies' surfaces, the size of the traction, equal weights."""
    if seen.bodies is None:
        return np.zeros((1, 3)), np.ones(1), np.ones(1)
    size = seen.bodies["traction size"]
    return seen.bodies.points, size, np.ones(len(size))


def _plain(name: str) -> Callable[[Scene], Span]:
    return lambda seen: span_in(seen.fluid.points, seen.fluid[name])


def _signed(name: str) -> Callable[[Scene], Span]:
    """The size that is exceeded on hardly any of the area, on both sides of zero."""

    def span(seen: Scene) -> Span:
        _, value, weight = shown(*_in_cells(name)(seen))
        largest = _exceeded(np.abs(value), weight, _FEW) or 1.0
        return -largest, largest

    return span


def _diverging(span: Span) -> Normalize:
    """Logarithmic on both sides of zero, linear in between: films hold far larger values than the rest."""
    return SymLogNorm(_LINEAR * max(map(abs, span)), vmin=span[0], vmax=span[1], base=10)


def _log(span: Span) -> Normalize:
    return LogNorm(*span)


def _linear(span: Span) -> Normalize:
    return Normalize(*span)


def _draw_speed(panel: Panel, seen: Scene, norm: Normalize) -> None:
    """Speed in colours, streamlines as level lines of the stream function: the closer, the faster."""
    u = seen.fluid["velocity"]
    seen.fluid["psi"] = stream_function(seen.fluid, seen.fluid["r"][:, None] * u if seen.axisymmetric else u)
    surface = seen.surface(("speed", "psi"), panel.size)
    panel.colour(surface, "speed", DRAWINGS["speed"].colours, norm)
    levels = np.linspace(*span_in(surface.points, surface["psi"]), _STREAMLINES + 2)[1:-1]
    panel.lines(surface.contour(levels, scalars="psi"), "white", width=3, opacity=0.8)


def _draw_mesh(panel: Panel, seen: Scene, norm: Normalize) -> None:
    """The cells, over the pressure."""
    panel.colour(seen.surface(("pressure",), panel.size), "pressure", _PALE, norm)
    panel.lines(edges(seen.fluid), INK, width=3)


def _draw_field(name: str, colours: Colormap) -> Callable[[Panel, Scene, Normalize], None]:
    return lambda panel, seen, norm: panel.colour(seen.surface((name,), panel.size), name, colours, norm)


def _draw_traction(panel: Panel, seen: Scene, norm: Normalize) -> None:
    """Ribbons inside the bodies along their surfaces, over the cells."""
    panel.fill(seen.surface((), panel.size), "white")
    if seen.bodies is None:
        return
    ribbon = rims(seen.bodies, _RIBBON).translate((0.0, 0.0, 3e-3))
    panel.colour(ribbon, "traction size", DRAWINGS["traction"].colours, norm)


_VIRIDIS, _MAGMA, _PLASMA = (colormaps[name] for name in ("viridis", "magma", "plasma"))
_RED_BLUE, _ORANGE_PURPLE = colormaps["RdBu_r"], colormaps["PuOr_r"]

# Perceptual, and told apart by every eye; bright is large, and signed fields are white at zero.
DRAWINGS = {
    "speed": Drawing(
        "|u|", "speed and streamlines", _VIRIDIS, _logarithmic("speed", _in_cells("speed")), _log,
        _draw_speed,
    ),
    "pressure": Drawing(
        "p", "pressure", _RED_BLUE, _signed("pressure"), _diverging, _draw_field("pressure", _RED_BLUE)
    ),
    "vorticity": Drawing(
        r"$\partial_x u_y - \partial_y u_x$", "vorticity", _ORANGE_PURPLE, _signed("vorticity"), _diverging,
        _draw_field("vorticity", _ORANGE_PURPLE),
    ),
    "dissipation": Drawing(
        r"$2 \mu\, e : e$", "dissipation", _MAGMA,
        _logarithmic("dissipation", _in_cells("dissipation")), _log, _draw_field("dissipation", _MAGMA),
    ),
    "traction": Drawing(
        r"$|\sigma n|$", "traction on the bodies", _PLASMA, _logarithmic("traction", _on_bodies), _log,
        _draw_traction,
    ),
    "mesh": Drawing("p", "pressure and mesh", _PALE, _plain("pressure"), _linear, _draw_mesh),
}  # fmt: skip
