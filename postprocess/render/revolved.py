"""Pictures of an axisymmetric flow in space: half of the turn, so that the inside is seen.

The eye is a little above the level of the spheres: from higher up, or with less cut away, the fluid would
hide parts of them, and what is left does not look round.
"""

from collections.abc import Iterator, Sequence
from itertools import repeat

import numpy as np
import pyvista as pv
from matplotlib.cm import ScalarMappable

from fsi.bodies.configuration import Configuration
from fsi.errors import InputError
from fsi.meshes.geometry.placed import Placed
from fsi.postprocess.render.canvas import Picture, new_spatial_panel
from fsi.postprocess.render.curved_cells import cells_within, refine
from fsi.postprocess.render.fields import rendered_field
from fsi.postprocess.render.picture import Artist, Framed, compose
from fsi.postprocess.render.scales import Shown
from fsi.postprocess.render.scenes import scene, window_on
from fsi.postprocess.render.view import Choice, View
from fsi.postprocess.run.run import Run

_EYE = (0.0, -1.0, 0.2)
_SECTORS = 90  # of the half turn
_ALONG = 200  # points from pole to pole of a body that is no sphere
_FINE = 100.0  # triangles across the window
_ASLANT = 1.2  # of the window over that of the plane: a cylinder is seen aslant


class RevolvedArtist(Artist):
    """Draws a field on the cut faces and the outside of the fluid, with the spheres whole."""

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such field, or a gap is asked for."""
        super().__init__(run, choice)
        self.field = rendered_field(choice.field or "speed").along("r", "z")
        if choice.gap is not None:
            raise InputError(f"--gap {choice.gap}: is shown on the plane; drop --revolved")
        if self.field.on_bodies:
            raise InputError(f"--field {self.field.name}: is shown on the plane; drop --revolved")

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        window = window_on(self.run, steps, self.run.mesh(steps[0]))
        shades = self.field.shades([self._seen(step, window) for step in steps], self.choice.span)
        ends = self.field.scale.cut if self.choice.span is None else "both"
        for step, view in zip(steps, repeat(window)):
            half = _ASLANT * view.half
            title = f"{self.field.name}, turned around the axis"
            framed = Framed(self._image(step, view, shades), title, half, self.field.label, shades, ends)
            yield compose(self.title(step), [framed], self.choice.theme)

    def _seen(self, step: int, window: View) -> Shown:
        """What colours the flat picture, to which nodes in films and on walls count for little."""
        flat = scene(self.run, step, self.run.mesh(step), window, tractions=False)
        return self.field.scale.seen(*flat.samples(self.field))

    def _image(self, step: int, window: View, shades: ScalarMappable) -> Picture:
        (_, bottom), (right, top) = window.low, window.high
        fluid = cells_within(self.run.mesh(step), np.array([0.0, bottom]), np.array([right, top]))
        flat = refine(fluid, self.field.needs, 2.0 * window.half / _FINE).clean()
        for normal, origin in (("x", right), ("y", top), ("-y", bottom)):
            flat = flat.clip(normal, origin=(origin, origin, 0.0)) if flat.n_points else flat
        flat["value"] = self.field.value(flat.point_data, self.run.case.fluid.viscosity)
        view = View(np.array([0.0, 0.0, window.centre[1]]), _ASLANT * window.half)
        r, z, _ = np.asarray(flat.points, dtype=float).T
        flat.points = view.local(np.column_stack([r, 0.0 * r, z]))
        turn = {"resolution": _SECTORS, "angle": 180.0, "rotation_axis": (0.0, 0.0, 1.0), "capping": True}
        panel = new_spatial_panel(view, self.choice.size, self.choice.theme)
        q = self.run.meshed(step)
        for body in q.placed:
            panel.skins(_skin(body, view))
        if not q.outlines:
            centres = np.column_stack([np.zeros((len(q), 2)), q.centres[:, 1]])
            panel.bodies(Configuration(centres, np.zeros((len(q), 3)), q.radii))
        panel.colour(flat.extrude_rotate(**turn), shades)
        return panel.image(_EYE)


def _skin(body: Placed, view: View) -> pv.PolyData:
    """The surface of a body of revolution, in the window's coordinates."""
    assert body.outline.poles is not None  # it is on an axis
    r, z = body.at(np.linspace(*body.outline.poles, _ALONG)).x.T
    half = pv.lines_from_points(view.local(np.column_stack([r, 0.0 * r, z])))
    return half.extrude_rotate(resolution=2 * _SECTORS, rotation_axis=(0.0, 0.0, 1.0), capping=False)
