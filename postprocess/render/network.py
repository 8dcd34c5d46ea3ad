"""Bodies, and lines between them: the contacts of runs that have no flow, the necks between pores.

Of a periodic domain one period is shown, with all images of bodies and lines that reach into the window.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, override

import numpy as np
import pyvista as pv
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, LogNorm, Normalize, SymLogNorm

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice
from fsi.postprocess.render.canvas import ASLANT, Picture, new_panel, new_spatial_panel
from fsi.postprocess.render.mean_flow import sliding_walls
from fsi.postprocess.render.periodic_box import PeriodicBox
from fsi.postprocess.render.picture import Artist, Cut, Framed, compose
from fsi.postprocess.render.scales import Span, one_colour
from fsi.postprocess.render.scenes import images
from fsi.postprocess.render.view import Choice, View, around_all, around_period
from fsi.postprocess.render.walls import draw_open_walls, inside_walls
from fsi.postprocess.run.grids import counted, nodes
from fsi.postprocess.run.run import Run

BODIES, CONTACTS, NECKS = "bodies", "contacts", "necks"
_FLOOR = 0.9  # of half a window, below its middle: no wall is shown above it
_LARGE = 0.15  # radius over half the window from which on lines do not widen with the bodies
# What the signs of a field mean.
_SIGNS = {
    "force": " (+ pulls, - pushes)",
    "gamma": " (- remembers a push)",
    "impulse": " (+ pushes, - pulls)",
    "solid": " (+ pushes)",
}
_TURNED = str.maketrans("+-", "-+")
_DECADES = 300.0  # ratio of the largest value to the least that has a colour of its own
_ROUNDING = 1e-6  # of the largest value: less on the other side of zero is none
_WIDEST, _THINNEST = 0.5, 0.02  # of a line, over the median radius
_DARK = ListedColormap(colormaps["inferno_r"](np.linspace(0.2, 0.95, 256)))  # seen on pale bodies
_TWO_SIDED = colormaps["coolwarm"]  # grey at zero


@dataclass(frozen=True)
class ContactNetwork:
    """The contacts of one step.

    Attributes:
        q: the bodies.
        ends: of the lines between them, (C, 2, 3).
        values: what is shown of each contact, (C,).
    """

    q: Configuration
    ends: Array
    values: Array


class NetworkArtist(Artist):
    """Draws bodies and contacts, with the same widths for the same values.

    Attributes:
        lines: the series of files with the lines.
        defaults: what is shown of the lines, the first that the run has.
    """

    series = BODIES
    lines: ClassVar[str] = CONTACTS
    defaults: ClassVar[tuple[str, ...]] = ("force", "gamma")

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such field, or a gap is asked for."""
        super().__init__(run, choice)
        if choice.gap is not None:
            raise InputError(f"--gap {choice.gap}: there is no flow in this run to look at; drop it")
        known = [*run.mesh(None, self.lines).cell_data]
        if choice.field is not None and choice.field not in known:
            raise InputError(f"--field {choice.field}: give one of {', '.join(known)}")
        shown = next((name for name in self.defaults if name in known), None)
        if choice.field is None and shown is None:
            what = f"{run.path}: its series {self.lines} has no {' or '.join(self.defaults)}"
            raise InputError(f"{what}; a file is not what the run has written: run the case again")
        self.field = choice.field or str(shown)

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        networks = [self._read(step) for step in steps]
        view = self._window(steps, networks)
        values, label = np.concatenate([network.values for network in networks]), self.field
        signs = _SIGNS.get(self.field, "")
        if values.max(initial=0.0) <= 0.0 < -values.min(initial=0.0):  # pushes: their sizes are shown
            networks = [replace(network, values=-network.values) for network in networks]
            values, label, signs = -values, f"-{label}", signs.translate(_TURNED)
        shades = _shades(values, self.choice.span)
        draw = self._plane if self.run.case.dimension == 2 else self._space
        ends: Cut = "neither" if self.choice.span is None and shades.norm.vmin == 0.0 else "both"
        for step, network in zip(steps, networks, strict=True):
            title = f"{self.lines}, width and colour by {label}{signs}" if values.size else f"no {self.lines}"
            meaning = shades if values.size else None
            framed = Framed(draw(step, network, view, shades), title, view.half, label, meaning, ends)
            yield compose(self.title(step), [framed], self.choice.theme)

    def _window(self, steps: Sequence[int], networks: Sequence[ContactNetwork]) -> View:
        """On one period, or on all bodies at all steps."""
        container = self.run.container(steps[0])
        if len(container.periods):
            if container.dimension == 2:
                return around_period(container)
            box = PeriodicBox.of(container).view()
            return replace(box, half=ASLANT * box.half)
        centres = np.stack([network.q.centres for network in networks])
        return self._above_floor(around_all(centres, networks[0].q.radii))

    def _above_floor(self, view: View) -> View:
        """The window, raised until it shows less of a wall below the bodies."""
        if self.run.case.dimension == 3:
            return view
        steps = np.linspace(0.0, 1.0, 51)[:, None] * [0.0, view.aspect * view.half]
        below = view.centre - [0.0, _FLOOR * view.aspect * view.half] + steps
        free = np.all(self.run.wall_distances(below) >= 0.0, axis=1)
        return replace(view, centre=view.centre + steps[np.argmax(free)])

    def _read(self, step: int) -> ContactNetwork:
        """Bodies and contacts of a step; a step without contacts has no values."""
        q, contacts = self._bodies(step), self.run.mesh(step, self.lines)
        if not contacts.n_cells:
            return ContactNetwork(q, np.empty((0, 2, 3)), np.empty(0))
        ends = np.asarray(contacts.points[nodes(contacts)], dtype=float)
        return ContactNetwork(q, ends, np.asarray(contacts.cell_data[self.field]))

    def _bodies(self, step: int) -> Configuration:
        bodies = self.run.mesh(step, BODIES)
        centres = np.asarray(bodies.points[:, : self.run.case.dimension], dtype=float)
        return Configuration.unturned(centres, np.asarray(bodies["radius"], dtype=float))

    def _widths(self, values: Array, view: View, shades: ScalarMappable) -> Array:
        """Widths of lines, (C,), as colours grow: parts of a body, of the window where bodies are large."""
        part = np.ma.filled(np.clip(shades.norm(values), 0.0, 1.0), 0.0)
        share = np.asarray(part) if shades.get_clim()[0] >= 0.0 else np.abs(2.0 * np.asarray(part) - 1.0)
        unit = min(float(np.median(self.run.case.configuration().radii)), _LARGE * view.half)
        widths: Array = unit * (_THINNEST + (_WIDEST - _THINNEST) * share)
        return widths

    def _plane(self, step: int, network: ContactNetwork, view: View, shades: ScalarMappable) -> Picture:
        """Bodies, and bars between their centres, the wider the larger the value."""
        container, q = self.run.container(step), network.q
        panel = new_panel(view, self.choice.size, self.choice.theme)
        if (inside := inside_walls(self.run, view)).n_points:
            panel.fill(inside, self.choice.theme.page)
        draw_open_walls(panel, self.run)
        if len(container.periods):
            q, _ = images(q, container, view)
        panel.bodies(q, turning=False, rims=1.5)
        ends, values = _lines(network, container, view)
        if len(values):
            panel.colour(_bars(ends, values, self._widths(values, view, shades), view), shades)
        panel.sliding(sliding_walls(self.run, step))
        return panel.image()

    def _space(self, step: int, network: ContactNetwork, view: View, shades: ScalarMappable) -> Picture:
        """Translucent spheres, and tubes between their centres; around them the box of a period."""
        container, q, near = self.run.container(step), network.q, view
        space = new_spatial_panel(view, self.choice.size, self.choice.theme)
        if len(container.periods):
            box, near = PeriodicBox.of(container, view.centre), replace(view, half=view.half / ASLANT)
            q = box.bodies(q, near)
            space.outline(view.local(box.edges), space.theme.ink)
        space.bodies(q, opacity=0.25)
        ends, values = _lines(network, container, near)
        if len(values):
            space.tubes(ends, 0.5 * self._widths(values, view, shades), values, shades)
        return space.image()


class NeckArtist(NetworkArtist):
    """Draws the necks between pores, by default as wide as what is dissipated in them: chains stand out."""

    series = NECKS
    lines = NECKS
    defaults = ("dissipation",)

    @override
    def _bodies(self, step: int) -> Configuration:
        return self.run.configuration(step)


def _lines(network: ContactNetwork, container: Container, view: View) -> tuple[Array, Array]:
    """The ends of all images of the lines that may reach into a window, (n, 2, 3), and their values, (n,)."""
    lattice, ends, values, d = Lattice(container.periods), network.ends, network.values, container.dimension
    if not (lattice.dimension and len(values)):
        return ends, values
    x = ends[..., :d]
    home = x - lattice.shift(lattice.nearest(x[:, 0] - view.centre))[:, None]
    longest = float(np.linalg.norm(x[:, 1] - x[:, 0], axis=1).max())
    e = lattice.shift(lattice.near(np.sqrt(d) * view.half + longest + lattice.longest()))
    every = (home + e[:, None, None]).reshape(-1, 2, d) - view.centre
    seen = np.all((every.min(axis=1) <= view.half) & (every.max(axis=1) >= -view.half), axis=1)
    shown = np.zeros((int(seen.sum()), 2, 3))
    shown[..., :d] = view.centre + every[seen]
    return shown, np.tile(values, len(e))[seen]


def _shades(values: Array, span: Span | None) -> ScalarMappable:
    """Logarithmic colours of sizes, or on both sides of zero where values have both signs."""
    low, high = span or (float(values.min(initial=0.0)), float(values.max(initial=0.0)))
    largest = max(-low, high)
    if span is not None and low <= 0.0:
        return ScalarMappable(Normalize(low, high), _DARK if low == 0.0 else _TWO_SIDED)
    if -low > _ROUNDING * largest:
        return ScalarMappable(SymLogNorm(largest / _DECADES, vmin=-largest, vmax=largest), _TWO_SIDED)
    if largest <= 0.0:
        return one_colour(0.0, _DARK)
    least = values[values > largest / _DECADES].min(initial=0.5 * largest) if span is None else low
    return ScalarMappable(LogNorm(float(least), largest), _DARK)


def _bars(ends: Array, values: Array, widths: Array, view: View) -> pv.PolyData:
    """A rectangle along each contact, in the window's coordinates; small values first, below large ones."""
    order = np.argsort(np.abs(values))
    start, end = ends[order, 0, :2], ends[order, 1, :2]
    along = end - start
    across = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1, keepdims=True)
    aside = 0.5 * widths[order, None] * across
    corners = np.stack([start - aside, end - aside, end + aside, start + aside], axis=1)
    points = view.local(corners).reshape(-1, 3)
    points[:, 2] = np.repeat(np.linspace(2e-3, 3e-3, len(order)), 4)  # each covers those before it
    bars = pv.PolyData(points, faces=counted(np.arange(len(points)).reshape(-1, 4)))
    bars["value"] = np.repeat(values[order], 4)
    return bars
