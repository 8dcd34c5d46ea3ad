"""A picture of things in space: lit spheres, surfaces and tubes, seen from one side and slightly above.

As in `fsi.postprocess.render.panel`, all is drawn in coordinates of the window, `(x - centre) / half`; the
projection is parallel, so that the scale bar holds everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyvista as pv
from matplotlib.colors import Colormap, Normalize
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration
from fsi.postprocess.render.panel import SAMPLES, SOLID, blank, coloured, photograph
from fsi.postprocess.render.view import View

_BODY = "#e8dfcf"
_FROM = (0.3, -1.0, 0.25)  # where the eye is, as seen from the centre


@dataclass(frozen=True, slots=True)
class Space:
    """A picture that is being drawn, size pixels wide and high; view: its centre (3,) and half its width."""

    plotter: pv.Plotter
    view: View
    size: int

    def local(self, x: Array) -> Array:
        """Points (..., 3) in the window's coordinates."""
        found: Array = (x - self.view.centre) / self.view.half
        return found

    def bodies(self, q: Configuration, opacity: float = 1.0) -> None:
        """Draw the spheres."""
        centres = pv.PolyData(self.local(q.centres))
        centres["radius"] = q.radii / self.view.half
        ball = pv.Icosphere(radius=1.0, nsub=5 if len(q) < 100 else 3)
        ball.clear_data()
        spheres = centres.glyph(geom=ball, scale="radius", orient=False)
        self.plotter.add_mesh(
            spheres, color=_BODY, smooth_shading=True, ambient=0.3, specular=0.2, opacity=opacity
        )

    def colour(self, surface: pv.PolyData, field: str, colours: Colormap, norm: Normalize) -> None:
        """Draw a surface, given in the window's coordinates, with a field in colours, unlit."""
        self.plotter.add_mesh(coloured(surface, field, norm), lighting=False, **_in(colours))

    def lines(self, lines: pv.PolyData) -> None:
        """Draw streamlines, given in the window's coordinates on a plane across y, a little before it."""
        if lines.n_points:
            lifted = lines.translate((0.0, -2e-3, 0.0))
            wide = max(1.0, 1.5 * SAMPLES * self.size / 1000.0)
            self.plotter.add_mesh(lifted, color="white", line_width=wide, opacity=0.8, lighting=False)

    def tubes(self, ends: Array, radii: Array, values: Array, colours: Colormap, norm: Normalize) -> None:
        """Draw tubes between points (n, 2, 3), coloured by values (n,)."""
        x = self.local(ends).reshape(-1, 3)
        lines = pv.PolyData(x, lines=np.insert(np.arange(len(x)).reshape(-1, 2), 0, 2, axis=1).ravel())
        lines["value"] = np.repeat(values, 2)
        lines["radius"] = np.repeat(radii / self.view.half, 2)
        tubes = lines.tube(scalars="radius", absolute=True, n_sides=16, capping=True)
        self.plotter.add_mesh(coloured(tubes, "value", norm), smooth_shading=True, **_in(colours))

    def floor(self, z: float) -> None:
        """Draw a horizontal wall."""
        height = (z - self.view.centre[2]) / self.view.half
        wall = pv.Plane(center=(0.0, 0.0, height - 1e-3), i_size=8.0, j_size=8.0)
        self.plotter.add_mesh(wall, color=SOLID, lighting=False)

    def image(self) -> NDArray[np.uint8]:
        """What has been drawn, (size, size, 3); ends the drawing."""
        eye = 20.0 * np.array(_FROM) / np.linalg.norm(_FROM)
        return photograph(self.plotter, eye.tolist(), (0.0, 0.0, 1.0), (1.0, 60.0))


def new_space(view: View, size: int) -> Space:
    """An empty picture."""
    plotter = blank(size, "white")
    plotter.enable_depth_peeling(8)
    return Space(plotter, view, size)


def _in(colours: Colormap) -> dict[str, object]:
    return {"scalars": "colour", "cmap": colours, "clim": (0.0, 1.0), "show_scalar_bar": False}
