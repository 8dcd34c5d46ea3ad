"""Pictures of the flow in space: spheres, and a vertical plane through them that shows a field; or a gap."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pyvista as pv
from matplotlib.colors import Normalize

from fsi.bodies.configuration import Array, Configuration
from fsi.errors import InputError
from fsi.meshes.geometry.containers import HalfPlane
from fsi.postprocess.choice import Choice, Span
from fsi.postprocess.render.animation import Picture
from fsi.postprocess.render.cut import FIELDS, Cut, flow_on, through_gap
from fsi.postprocess.render.fields_shown import DRAWINGS
from fsi.postprocess.render.figure import Framed, compose
from fsi.postprocess.render.panel import new_panel
from fsi.postprocess.render.space import new_space
from fsi.postprocess.render.view import View, around_all, gap_between, parse_sides
from fsi.postprocess.run.run import Run

_WIDE = 2.2  # of the window over that which just holds the bodies
_MARGIN = 1.08  # of a window around the whole domain
_REACH = 1.35  # of the plane over the window, half its width
_X = np.array([1.0, 0.0, 0.0])

type Flow = tuple[pv.PolyData, pv.PolyData]


class SpatialArtist:
    """Draws a run in space: the same plane and window, and the same colours for the same values."""

    series = "fluid"

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such field or gap."""
        if choice.field is not None and choice.field not in FIELDS:
            raise InputError(f"--field {choice.field}: give one of {', '.join(FIELDS)}")
        walls = run.case.container().walls
        self.sides = None if choice.gap is None else parse_sides(choice.gap, run.case.names, walls)
        self.field = choice.field or ("speed" if self.sides is None else "pressure")
        self.run, self.choice = run, choice

    def require_fields(self, step: int) -> None:
        """All steps have the same."""

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        q = [self.run.configuration(step) for step in steps]
        around = self._window(steps[0], np.stack([at.centres for at in q]), q[0].radii)
        seen = [self._cut(step, at, around) for step, at in zip(steps, q, strict=True)]
        reach = _REACH if self.sides is None else 1.0
        flows = [
            flow_on(self.run, step, cut, self.field, reach)
            for step, (cut, _) in zip(steps, seen, strict=True)
        ]
        span = self.choice.span or _span(self.field, np.concatenate([plane["value"] for plane, _ in flows]))
        for step, at, (cut, title), flow in zip(steps, q, seen, flows, strict=True):
            draw = self._space if self.sides is None else self._close_up
            drawing = DRAWINGS[self.field]
            norm = drawing.norm(span)
            image = draw(flow, cut, at, norm)
            framed = Framed(image, title, cut.half, drawing.label, drawing.colours, norm, cut=True)
            yield compose(f"{self.run.name},  t = {self.run.times[step]:.6g}", [framed])

    def _window(self, step: int, centres: Array, radii: Array) -> View:
        """A cube around the bodies at all steps, or around the domain where that is smaller."""
        near = around_all(centres, radii)
        low, high = np.array(self.run.mesh(step).bounds).reshape(3, 2).T
        whole = _MARGIN * 0.5 * float(np.max(high - low))
        if whole > _WIDE * near.half:
            return View(near.centre, _WIDE * near.half)
        middle = 0.5 * (low + high)
        return View(np.array([middle[0], near.centre[1], middle[2]]), whole)

    def _cut(self, step: int, q: Configuration, around: View) -> tuple[Cut, str]:
        """The plane that is shown at a step, and what is said of it."""
        what = "speed, streamlines" if self.field == "speed" else self.field
        if self.sides is None:
            cut = Cut(around.centre, around.half, _X)
            return cut, f"{what} on the plane {cut.name}"
        names = [*self.run.case.names, *self.run.case.container().walls]
        gap = gap_between(q, self.run.container(step), self.sides)
        cut = through_gap(gap, q, gap.close_up(around))
        between = " - ".join(names[side] for side in gap.sides)
        return cut, f"gap {between}, {gap.width:.3g}: {self.field}, plane {cut.name}"

    def _space(self, flow: Flow, cut: Cut, q: Configuration, norm: Normalize) -> Picture:
        """The spheres, and the plane behind and in front of them."""
        plane, lines = (_upright(part) for part in flow)
        space = new_space(View(cut.centre, cut.half), self.choice.size)
        space.colour(plane, "value", DRAWINGS[self.field].colours, norm)
        space.lines(lines)
        space.bodies(q)
        if isinstance(self.run.case.container(), HalfPlane):
            space.floor(0.0)
        return space.image()

    def _close_up(self, flow: Flow, cut: Cut, q: Configuration, norm: Normalize) -> Picture:
        """The plane alone, and where it cuts the spheres."""
        plane, lines = flow
        panel = new_panel(View(np.zeros(2), 1.0), self.choice.size)
        panel.colour(plane, "value", DRAWINGS[self.field].colours, norm)
        panel.lines(lines, "white", width=3, opacity=0.8, layer=0.5)
        panel.bodies(cut.circles(q), turning=False)
        return panel.image()


def _upright(flat: pv.PolyData) -> pv.PolyData:
    """(s, t, 0) to (s, 0, t), in the window's coordinates in space."""
    found = flat.copy()
    if found.n_points:
        found.points = np.asarray(flat.points)[:, [0, 2, 1]]
    return found


def _span(name: str, values: Array) -> Span:
    """The largest speed and two decades less, or the largest size on both sides of zero."""
    largest = float(np.abs(values).max()) or 1.0
    return (1e-2 * largest, largest) if name == "speed" else (-largest, largest)
