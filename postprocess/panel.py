"""One square panel of a picture: a window on the plane, with fields, lines and bodies in layers.

Everything is drawn in the window's own coordinates, `(x - centre) / half` in [-1, 1]: graphics works in
single precision, and a film of 1e-5 radii would drown in its rounding far from the origin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyvista as pv
from matplotlib.colors import Colormap
from numpy.typing import NDArray

from fsi.bodies import Array, Configuration

INK = "#222222"
_SOLID, _BODY = "#c9c9c9", "#f3efe6"
_DISC_SIDES = 4000  # sagitta 3e-7 a: a film of 1e-5 a stays open
_LAYER = 1e-3  # distance towards the eye by which one layer covers the next

type Span = tuple[float, float]


@dataclass(frozen=True, slots=True)
class View:
    """A square window on the plane: its centre, shape (2,), and half its width."""

    centre: Array
    half: float

    @property
    def low(self) -> Array:
        """Lower left corner."""
        return self.centre - self.half

    @property
    def high(self) -> Array:
        """Upper right corner."""
        return self.centre + self.half

    def local(self, x: Array) -> Array:
        """Points (..., 2) of the plane in the window's coordinates, with z = 0, shape (..., 3)."""
        inside = (x[..., :2] - self.centre) / self.half
        return np.concatenate([inside, np.zeros_like(inside[..., :1])], axis=-1)


@dataclass(frozen=True, slots=True)
class Panel:
    """The panel in a column of a plotter's lower row; its title is above, its colour bar to the right."""

    plotter: pv.Plotter
    column: int
    view: View

    def title(self, text: str) -> None:
        """Write the title."""
        self.plotter.subplot(0, self.column)
        self.plotter.add_text(text, position=(0.01, 0.25), viewport=True, font_size=15, color=INK)

    def span(self, surface: pv.PolyData, field: str) -> Span:
        """Least and largest value of a field on what the window shows, or anywhere if it shows none."""
        shown = np.all(np.abs(surface.points[:, :2]) <= 1.0, axis=1)
        values = surface[field][shown] if shown.any() else surface[field]
        return float(values.min()), float(values.max())

    def colour(
        self, surface: pv.PolyData, field: str, colours: str | Colormap, span: Span, log_scale: bool = False
    ) -> None:
        """Draw a field of a surface, given in the window's coordinates, in colours, and its bar."""
        self.plotter.subplot(1, self.column)
        actor = self.plotter.add_mesh(
            surface,
            scalars=field,
            cmap=colours,
            clim=span,
            log_scale=log_scale,
            lighting=False,
            show_scalar_bar=False,
        )
        self.plotter.subplot(1, self.column + 1)
        self.plotter.add_scalar_bar(
            title=field,
            mapper=actor.mapper,
            color=INK,
            vertical=True,
            position_x=0.1,
            position_y=0.1,
            width=0.8,
            height=0.8,
            fmt="{:.4g}",
            title_font_size=24,
            label_font_size=20,
        )

    def lines(
        self, lines: pv.PolyData, colour: str, width: float, opacity: float = 1.0, layer: int = 2
    ) -> None:
        """Draw lines that are given in the window's coordinates."""
        if lines.n_points:
            self.plotter.subplot(1, self.column)
            lifted = lines.translate((0.0, 0.0, layer * _LAYER))
            self.plotter.add_mesh(lifted, color=colour, line_width=width, opacity=opacity)

    def frame(self, view: View) -> None:
        """Draw the outline of another window."""
        (x0, y0), (x1, y1) = view.low, view.high
        corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]])
        self.lines(pv.lines_from_points(self.view.local(corners)), "#d55e00", width=5, layer=4)

    def bodies(self, q: Configuration, turning: bool) -> None:
        """Draw the discs, each with a radius that turns with it where they can turn."""
        if not len(q):
            return
        turn = np.linspace(0.0, 2.0 * np.pi, _DISC_SIDES, endpoint=False)
        circle = np.column_stack([np.cos(turn), np.sin(turn)])
        rims = q.centres[:, None] + q.radii[:, None, None] * circle
        faces = np.arange(len(q) * _DISC_SIDES).reshape(len(q), -1)
        discs = pv.PolyData(self.view.local(rims).reshape(-1, 3), faces=_counted(faces))
        self.plotter.subplot(1, self.column)
        self.plotter.add_mesh(discs.translate((0.0, 0.0, _LAYER)), color=_BODY, lighting=False)
        if not turning:
            return
        pointers = 0.8 * q.radii[:, None] * np.column_stack([np.cos(q.angles), np.sin(q.angles)])
        ends = self.view.local(np.stack([q.centres, q.centres + pointers], axis=1)).reshape(-1, 3)
        self.lines(pv.PolyData(ends, lines=_counted(np.arange(len(ends)).reshape(-1, 2))), INK, width=4)

    def finish(self) -> None:
        """Place the camera; whatever has not been drawn on is wall."""
        self.plotter.subplot(1, self.column)
        self.plotter.set_background(_SOLID, all_renderers=False)
        self.plotter.view_xy()
        self.plotter.enable_parallel_projection()
        self.plotter.camera.focal_point = (0.0, 0.0, 0.0)
        self.plotter.camera.position = (0.0, 0.0, 4.0)
        self.plotter.camera.parallel_scale = 1.0
        self.plotter.camera.clipping_range = (1.0, 8.0)


def _counted(cells: NDArray[np.intp]) -> NDArray[np.intp]:
    """VTK's list of cells: each row led by its length."""
    return np.insert(cells, 0, cells.shape[1], axis=1).ravel()
