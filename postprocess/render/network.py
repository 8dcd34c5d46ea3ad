"""Pictures of runs that have no flow, reduced and gluey: bodies, and their contacts as lines between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pyvista as pv
from matplotlib import colormaps
from matplotlib.colors import Colormap, ListedColormap, Normalize

from fsi.bodies.configuration import Array, Configuration
from fsi.errors import InputError
from fsi.postprocess.choice import Choice, Span
from fsi.postprocess.render.animation import Picture
from fsi.postprocess.render.figure import Framed, compose
from fsi.postprocess.render.panel import counted, new_panel
from fsi.postprocess.render.space import new_space
from fsi.postprocess.render.view import View, around_all
from fsi.postprocess.run.run import Run

BODIES, CONTACTS = "bodies", "contacts"
DEFAULTS = ("force", "gamma")  # whichever of them the run has
_FLOOR = 0.9  # of half a window, below its middle: no wall is shown above it
_LARGE = 0.15  # radius over half the window from which on lines do not widen with the bodies
_WIDEST, _THINNEST = 0.5, 0.02  # of a line, over the median radius
_DARK = ListedColormap(colormaps["inferno_r"](np.linspace(0.2, 0.95, 256)))  # seen on pale bodies
_TWO_SIDED = colormaps["coolwarm"]  # grey at zero


@dataclass(frozen=True)
class Network:
    """The contacts of one step: ends (C, 2, 3), and the value that is shown of each, (C,)."""

    q: Configuration
    ends: Array
    values: Array


class NetworkArtist:
    """Draws bodies and contacts: the same window and the same colours and widths for the same values."""

    series = BODIES

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such field, or a gap is asked for."""
        if choice.gap is not None:
            raise InputError(f"--gap {choice.gap}: there is no flow in this run to look at; drop it")
        known = [*run.mesh(None, CONTACTS).cell_data]
        fields = [name for name in DEFAULTS if name in known]
        if choice.field is not None and choice.field not in known:
            raise InputError(f"--field {choice.field}: give one of {', '.join(known)}")
        self.run, self.choice = run, choice
        self.field = choice.field or fields[0]

    def require_fields(self, step: int) -> None:
        """All steps have the same."""

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        networks = [self._read(step) for step in steps]
        centres = np.stack([network.q.centres for network in networks])
        view = self._above_floor(around_all(centres, networks[0].q.radii))
        values = np.concatenate([network.values for network in networks])
        colours, norm = _scale(values, self.choice.span)
        for step, network in zip(steps, networks, strict=True):
            draw = self._plane if network.q.dimension == 2 else self._space
            image = draw(network, view, colours, norm)
            title = f"{self.run.name},  t = {self.run.times_of(BODIES)[step]:.6g}"
            yield compose(title, [Framed(image, "contacts", view.half, self.field, colours, norm)])

    def _above_floor(self, view: View) -> View:
        """The window, raised until it shows less of a wall below the bodies."""
        if self.run.dimension == 3:
            return view
        steps = np.linspace(0.0, 1.0, 51)[:, None] * [0.0, view.half]
        below = view.centre - [0.0, _FLOOR * view.half] + steps
        free = np.all(wall_distances(self.run, below) >= 0.0, axis=1)
        return View(view.centre + steps[np.argmax(free)], view.half)

    def _read(self, step: int) -> Network:
        """Bodies and contacts of a step; a step without contacts has no values."""
        bodies, contacts = self.run.mesh(step, BODIES), self.run.mesh(step, CONTACTS)
        centres = np.asarray(bodies.points[:, : self.run.dimension], dtype=float)
        q = Configuration.unturned(centres, np.asarray(bodies["radius"], dtype=float))
        if not contacts.n_cells:
            return Network(q, np.empty((0, 2, 3)), np.empty(0))
        ends = contacts.points[contacts.cell_connectivity.reshape(-1, 2)]
        return Network(q, np.asarray(ends, dtype=float), np.asarray(contacts.cell_data[self.field]))

    def _plane(self, network: Network, view: View, colours: Colormap, norm: Normalize) -> Picture:
        """Discs, and bars between their centres, the wider the larger the value."""
        panel = new_panel(view, self.choice.size)
        inside = _inside(self.run, view)
        if inside is not None:
            panel.fill(inside, "white")
        panel.bodies(network.q, turning=False, rims=True)
        if len(network.values):
            panel.colour(_bars(network, view, norm), "value", colours, norm)
        return panel.image()

    def _space(self, network: Network, view: View, colours: Colormap, norm: Normalize) -> Picture:
        """Translucent spheres, and tubes between their centres."""
        space = new_space(view, self.choice.size)
        space.bodies(network.q, opacity=0.25)
        if len(network.values):
            width = _widths(network, view, norm)
            space.tubes(network.ends, 0.5 * width, network.values, colours, norm)
        return space.image()


def _scale(values: Array, span: Span | None) -> tuple[Colormap, Normalize]:
    """Colours from zero to the largest value, or on both sides of zero where values have both signs."""
    low, high = (float(values.min(initial=0.0)), float(values.max(initial=0.0))) if span is None else span
    if low < 0.0 < high and min(-low, high) > 1e-6 * max(-low, high):
        largest = max(-low, high)
        return _TWO_SIDED, Normalize(-largest, largest) if span is None else Normalize(low, high)
    if low == high:
        high = low + 1.0
    return _DARK if abs(high) >= abs(low) else _DARK.reversed(), Normalize(low, high)


def _widths(network: Network, view: View, norm: Normalize) -> Array:
    """Widths of the lines, (C,): parts of a body, and of the window where bodies are large in it."""
    largest = max(abs(float(norm.vmin or 0.0)), abs(float(norm.vmax or 0.0)))
    share = np.clip(np.abs(network.values) / largest, 0.0, 1.0)
    unit = min(float(np.median(network.q.radii)), _LARGE * view.half)
    widths: Array = unit * (_THINNEST + (_WIDEST - _THINNEST) * share)
    return widths


def _bars(network: Network, view: View, norm: Normalize) -> pv.PolyData:
    """A rectangle along each contact, in the window's coordinates; small values first, below large ones."""
    order = np.argsort(np.abs(network.values))
    start, end = network.ends[order, 0, :2], network.ends[order, 1, :2]
    along = end - start
    across = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1, keepdims=True)
    aside = 0.5 * _widths(network, view, norm)[order, None] * across
    corners = np.stack([start - aside, end - aside, end + aside, start + aside], axis=1)
    points = view.local(corners).reshape(-1, 3)
    points[:, 2] = np.repeat(np.linspace(2e-3, 3e-3, len(order)), 4)  # each covers those before it
    bars = pv.PolyData(points, faces=counted(np.arange(len(points)).reshape(-1, 4)))
    bars["value"] = np.repeat(network.values[order], 4)
    return bars


def _inside(run: Run, view: View) -> pv.PolyData | None:
    """The part of the window between the walls; None where nothing in it is wall."""
    plane = pv.Plane(i_size=2.0, j_size=2.0, i_resolution=400, j_resolution=400)
    distances = wall_distances(run, view.centre + view.half * np.asarray(plane.points[:, :2], dtype=float))
    if not distances.size:
        return plane
    plane["distance"] = distances.min(axis=1)
    inside: pv.PolyData = plane.clip_scalar(scalars="distance", invert=False, value=0.0)
    return inside


def wall_distances(run: Run, x: Array) -> Array:
    """Distance of points (n, 2) to each wall, (n, walls); a gluey case lists planes and a cell."""
    if run.model != "gluey":
        return run.case.container().distances(x)
    data = run.data
    found = [_to_plane(x, wall["point"], wall["normal"]) for wall in data.get("walls", ())]
    cell = data.get("cell")
    for axis, unit in enumerate(np.eye(2)):
        if cell is not None and "xy"[axis] not in cell.get("periodic", ()):
            found += [_to_plane(x, cell["lower"], unit), _to_plane(x, cell["upper"], -unit)]
    return np.column_stack(found) if found else np.empty((len(x), 0))


def _to_plane(x: Array, point: Sequence[float], normal: Sequence[float] | Array) -> Array:
    """Distances (n,) to the wall through a point, positive where its normal points."""
    distances: Array = (x - np.array(point)) @ np.array(normal) / np.linalg.norm(normal)
    return distances
