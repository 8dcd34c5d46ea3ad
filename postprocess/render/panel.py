"""One square panel of a picture: a window on the plane, with fields, lines and bodies in layers.

Everything is drawn in the window's own coordinates, `(x - centre) / half` in [-1, 1]: graphics works in
single precision, and a film of 1e-5 radii would drown in its rounding far from the origin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyvista as pv
from matplotlib.colors import Colormap, Normalize
from numpy.typing import NDArray
from PIL import Image

from fsi.bodies.configuration import Array, Configuration
from fsi.postprocess.render.view import View

SAMPLES = 2  # of a pixel along each side
INK = "#222222"
SOLID, _BODY = "#c9c9c9", "#f3efe6"
_FEWEST_SIDES, _MOST_SIDES = 64, 4000  # of a disc; the most: sagitta 3e-7 a, a film of 1e-5 a stays open
_LAYER = 1e-3  # distance towards the eye by which one layer covers the next


@dataclass(frozen=True, slots=True)
class Panel:
    """A panel that is being drawn, size pixels wide and high; what has not been drawn on is wall."""

    plotter: pv.Plotter
    view: View
    size: int

    def colour(self, surface: pv.PolyData, field: str, colours: Colormap, norm: Normalize) -> None:
        """Draw a field of a surface, given in the window's coordinates, in colours."""
        self.plotter.add_mesh(
            coloured(surface, field, norm),
            scalars="colour",
            cmap=colours,
            clim=(0.0, 1.0),
            lighting=False,
            show_scalar_bar=False,
        )

    def fill(self, surface: pv.PolyData, colour: str) -> None:
        """Draw a surface, given in the window's coordinates, in one colour."""
        self.plotter.add_mesh(surface, color=colour, lighting=False)

    def lines(
        self, lines: pv.PolyData, colour: str, width: float, opacity: float = 1.0, layer: float = 2.0
    ) -> None:
        """Draw lines that are given in the window's coordinates, `width` thousandths of it wide."""
        if lines.n_points:
            lifted = lines.translate((0.0, 0.0, layer * _LAYER))
            wide = max(1.0, 0.5 * SAMPLES * width * self.size / 1000.0)
            self.plotter.add_mesh(lifted, color=colour, line_width=wide, opacity=opacity)

    def frame(self, view: View) -> None:
        """Draw the outline of another window."""
        (x0, y0), (x1, y1) = view.low, view.high
        corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]])
        self.lines(pv.lines_from_points(self.view.local(corners)), "#d55e00", width=5, layer=4)

    def bodies(self, q: Configuration, turning: bool, rims: bool = False) -> None:
        """Draw the discs, each with a radius that turns with it where they can turn, perhaps with rims."""
        seen = np.all(np.abs(q.centres - self.view.centre) < self.view.half + q.radii[:, None], axis=1)
        if not seen.any():
            return
        centres, radii, angles = q.centres[seen], q.radii[seen], q.angles[seen]
        # The sagitta of a side is a tenth of a pixel.
        sides = np.pi * np.sqrt(radii.max() / self.view.half * self.size / 0.4)
        turn = np.linspace(0.0, 2.0 * np.pi, int(np.clip(sides, _FEWEST_SIDES, _MOST_SIDES)), endpoint=False)
        circle = np.column_stack([np.cos(turn), np.sin(turn)])
        rim = centres[:, None] + radii[:, None, None] * circle
        faces = np.arange(rim.size // 2).reshape(len(radii), -1)
        discs = pv.PolyData(self.view.local(rim).reshape(-1, 3), faces=counted(faces))
        self.fill(discs.translate((0.0, 0.0, _LAYER)), _BODY)
        if rims:
            around = np.insert(faces, 0, faces[:, -1], axis=1)
            self.lines(pv.PolyData(discs.points, lines=counted(around)), INK, width=1.5, opacity=0.5, layer=1)
        if not turning:
            return
        pointers = 0.8 * radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
        ends = self.view.local(np.stack([centres, centres + pointers], axis=1)).reshape(-1, 3)
        self.lines(pv.PolyData(ends, lines=counted(np.arange(len(ends)).reshape(-1, 2))), INK, width=4)

    def image(self) -> NDArray[np.uint8]:
        """What has been drawn, (size, size, 3); ends the drawing."""
        return photograph(self.plotter, (0.0, 0.0, 4.0), (0.0, 1.0, 0.0), (1.0, 8.0))


def new_panel(view: View, size: int) -> Panel:
    """An empty panel."""
    return Panel(blank(size, SOLID), view, size)


def blank(size: int, background: str) -> pv.Plotter:
    """A plotter for a picture size pixels wide and high, which `photograph` ends."""
    plotter = pv.Plotter(off_screen=True, window_size=[SAMPLES * size] * 2)
    plotter.set_background(background)
    plotter.disable_anti_aliasing()  # there are samples enough
    return plotter


def photograph(
    plotter: pv.Plotter, eye: Sequence[float], up: Sequence[float], clipping: tuple[float, float]
) -> NDArray[np.uint8]:
    """What has been drawn in [-1, 1]^3, seen from afar, each pixel the mean of its samples."""
    plotter.enable_parallel_projection()
    camera = plotter.camera
    camera.focal_point, camera.position, camera.up = (0.0, 0.0, 0.0), tuple(eye), tuple(up)
    camera.parallel_scale = 1.0
    camera.clipping_range = clipping
    samples = Image.fromarray(plotter.screenshot(return_img=True))
    plotter.close()
    size = (samples.width // SAMPLES, samples.height // SAMPLES)
    return np.asarray(samples.resize(size, Image.Resampling.HAMMING))


def coloured(surface: pv.PolyData, field: str, norm: Normalize) -> pv.PolyData:
    """The surface with the point data `colour`, the field in [0, 1] as the norm says."""
    surface["colour"] = np.clip(norm(surface[field]), 0.0, 1.0).filled(0.0).astype(float)
    return surface


def shown(points: Array, values: Array, weights: Array) -> tuple[Array, Array, Array]:
    """Those of points (n, ...) that a window shows, with values and weights, or all if it shows none."""
    seen = np.all(np.abs(points[:, :2]) <= 1.0, axis=1)
    seen = seen if seen.any() else ~seen
    return points[seen], values[seen], weights[seen]


def span_in(view_points: Array, values: Array) -> tuple[float, float]:
    """Least and largest value at the points that a window shows, or anywhere if it shows none."""
    _, values, _ = shown(view_points, values, values)
    return float(values.min()), float(values.max())


def counted(cells: NDArray[np.intp]) -> NDArray[np.intp]:
    """VTK's list of cells: each row led by its length."""
    return np.insert(cells, 0, cells.shape[1], axis=1).ravel()
