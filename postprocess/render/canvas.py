"""What pictures are drawn on: a square panel that shows a window on the plane, or one that looks into space.

Everything is drawn in the window's own coordinates, `(x - centre) / half` in [-1, 1]: graphics works in
single precision, and a film of 1e-5 radii would drown in its rounding far from the origin. The projection is
parallel, so that the scale bar holds everywhere.
"""

import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyvista as pv
from matplotlib.cm import ScalarMappable
from numpy.typing import NDArray
from PIL import Image

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.errors import InputError
from fsi.postprocess.plots.figure import LIGHT, Theme
from fsi.postprocess.render.body_polygons import body_polygons, filled, outlined
from fsi.postprocess.render.mean_flow import MovingWall
from fsi.postprocess.render.view import View
from fsi.postprocess.run.grids import counted

type Picture = NDArray[np.uint8]

SAMPLES = 2  # of a pixel along each side
INK = "#222222"
ASLANT = 1.35  # of the window in space over that of the plane: a box is seen aslant
_LAYER = 1e-3  # distance towards the eye by which one layer covers the next
# Arrows in walls, over half the width of the window: how far behind, how long, how far apart, their heads.
_BEHIND, _LONGEST, _APART, _HEAD = 0.06, 0.4, 0.6, 0.025
_EYE = (0.45, -1.0, 0.35)  # where the eye is in space, as seen from the centre: slightly above

_SETTING = "VTK_DEFAULT_OPENGL_WINDOW"
_WINDOWS = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow", "vtkXOpenGLRenderWindow")
_DRAW = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderWindow
window = vtkRenderWindow()
window.SetOffScreenRendering(True)
window.Render()
raise SystemExit(not window.SupportsOpenGL())
"""


@dataclass(frozen=True, slots=True)
class _Canvas:
    """What is drawn on.

    Attributes:
        plotter: of pyvista.
        view: the window that fills it, in space a cube.
        size: its width in pixels.
        theme: its colours.
    """

    plotter: pv.Plotter
    view: View
    size: int
    theme: Theme

    def wide(self, thousandths: float) -> float:
        """The width of a line, in samples."""
        return max(1.0, 0.5 * SAMPLES * thousandths * self.size / 1000.0)

    def colour(self, surface: pv.PolyData, shades: ScalarMappable, lit: bool = False) -> None:
        """Draw the data `value` of a surface, given in the window's coordinates, in colours, perhaps lit."""
        parts = np.clip(shades.norm(surface["value"]), 0.0, 1.0)
        surface["colour"] = np.ma.filled(parts, 0.0).astype(float)
        colours = {"scalars": "colour", "cmap": shades.cmap, "clim": (0.0, 1.0), "show_scalar_bar": False}
        light = {"lighting": lit, "smooth_shading": lit, "ambient": 0.3 if lit else 0.0}
        if surface.n_points:
            self.plotter.add_mesh(surface, **light, **colours)


class Panel(_Canvas):
    """A panel that shows the plane; what has not been drawn on is wall."""

    __slots__ = ()

    def fill(self, surface: pv.PolyData, colour: str) -> None:
        """Draw a surface, given in the window's coordinates, in one colour."""
        if surface.n_points:
            self.plotter.add_mesh(surface, color=colour, lighting=False)

    def lines(
        self, lines: pv.PolyData, colour: str, width: float, opacity: float = 1, layer: float = 2
    ) -> None:
        """Draw lines that are given in the window's coordinates, `width` thousandths of it wide."""
        if lines.n_points:
            lifted = lines.translate((0.0, 0.0, layer * _LAYER))
            self.plotter.add_mesh(lifted, color=colour, line_width=self.wide(width), opacity=opacity)

    def frame(self, view: View) -> None:
        """Draw the outline of another window."""
        right, up = view.sides
        corners = view.centre + np.array([-right - up, right - up, right + up, up - right, -right - up])
        self.lines(pv.lines_from_points(self.view.local(corners)), "#d55e00", width=5, layer=4)

    def sliding(self, walls: Sequence[MovingWall]) -> None:
        """Draw arrows in walls, as long as these are fast."""
        fastest = max((abs(wall.speed) for wall in walls), default=0.0)
        for wall in walls:
            place, behind = self.view.centre.copy(), _BEHIND * self.view.half
            room = self.view.reach[wall.axis] - wall.outward * (wall.place - place[wall.axis])
            if 0.0 < room < 2.0 * behind:  # of the wall less than that is seen
                behind = 0.5 * room
            place[wall.axis] = wall.place + wall.outward * behind
            along = np.eye(2)[1 - wall.axis] * _LONGEST * self.view.half * wall.speed / fastest
            shift = np.eye(2)[1 - wall.axis] * _APART * self.view.half
            for k in (-1.0, 0.0, 1.0):
                self.arrow(place + k * shift - 0.5 * along, along)

    def arrow(self, start: Array, along: Array) -> None:
        """Draw an arrow from a point (2,) by a vector (2,)."""
        tip, turned = self.view.half * _HEAD, np.array([-along[1], along[0]])
        unit, aside = along / np.linalg.norm(along), turned / np.linalg.norm(turned)
        neck, end = start + along - 2.0 * tip * unit, start + along
        ink = 0.25 * tip * aside
        outline = [
            start - ink,
            neck - ink,
            neck - tip * aside,
            end,
            neck + tip * aside,
            neck + ink,
            start + ink,
        ]
        points = self.view.local(np.array(outline))
        shape = pv.PolyData(points, faces=counted(np.arange(7)[None])).triangulate()
        self.fill(shape.translate((0.0, 0.0, 3.0 * _LAYER)), self.theme.ink)

    def bodies(self, q: Configuration, turning: bool, rims: float = 0.0) -> None:
        """Draw the discs, each with a radius that turns with it where they can turn.

        rims: thousandths of the window that the lines around them are wide; 0 for none.
        """
        seen = self._seen(q)
        if not seen.any():
            return
        polygons = body_polygons(q, seen, self.view, self.size)
        self.fill(filled(polygons).translate((0.0, 0.0, _LAYER)), self.theme.disc)
        if rims:
            self.lines(outlined(polygons), INK, width=rims, opacity=0.5, layer=1)
        if turning:
            centres, angles = q.centres[seen], q.angles[seen]
            pointers = 0.8 * q.radii[seen, None] * np.column_stack([np.cos(angles), np.sin(angles)])
            ends = self.view.local(np.stack([centres, centres + pointers], axis=1))
            self.lines(segments(ends), INK, width=4)

    def coloured_bodies(self, q: Configuration, values: Array, shades: ScalarMappable) -> None:
        """Draw the discs in the colours of their values, (N,)."""
        seen = self._seen(q)
        if seen.any():
            polygons = body_polygons(q, seen, self.view, self.size)
            discs = filled(polygons)
            discs["value"] = np.repeat(values[seen], [len(corners) for corners in polygons])
            self.colour(discs.translate((0.0, 0.0, _LAYER)), shades)

    def _seen(self, q: Configuration) -> NDArray[np.bool_]:
        """Which bodies meet the window, (N,)."""
        seen: NDArray[np.bool_] = np.all(
            np.abs(q.centres - self.view.centre) < self.view.reach + q.radii[:, None], axis=1
        )
        return seen

    def image(self) -> Picture:
        """What has been drawn, (size, size, 3); ends the drawing."""
        up = (*self.view.up, 0.0)
        return _photograph(self.plotter, (0.0, 0.0, 4.0), up, (1.0, 8.0), self.view.aspect)


class SpatialPanel(_Canvas):
    """A panel that shows things in space, seen from one side and slightly above."""

    __slots__ = ()

    def bodies(self, q: Configuration, opacity: float = 1.0) -> None:
        """Draw the spheres, lit."""
        centres = pv.PolyData(self.view.local(q.centres))
        centres["radius"] = q.radii / self.view.half
        ball = pv.Icosphere(radius=1.0, nsub=5 if len(q) < 100 else 3)
        ball.clear_data()
        self.skins(centres.glyph(geom=ball, scale="radius", orient=False), opacity)

    def skins(self, surfaces: pv.PolyData, opacity: float = 1.0) -> None:
        """Draw surfaces of bodies, given in the window's coordinates, lit."""
        light = {"smooth_shading": True, "ambient": 0.3, "specular": 0.2}
        self.plotter.add_mesh(surfaces, color=self.theme.sphere, opacity=opacity, **light)

    def outline(self, ends: Array, colour: str) -> None:
        """Draw straight lines between points (n, 2, 3) in the window's coordinates."""
        self.plotter.add_mesh(segments(ends), color=colour, lighting=False, line_width=self.wide(3.0))

    def tubes(self, ends: Array, radii: Array, values: Array, shades: ScalarMappable) -> None:
        """Draw tubes between points (n, 2, 3), coloured by values (n,)."""
        lines = segments(self.view.local(ends))
        lines["value"] = np.repeat(values, 2)
        lines["radius"] = np.repeat(radii / self.view.half, 2)
        tubes = lines.tube(scalars="radius", absolute=True, n_sides=16, capping=True)
        self.colour(tubes, shades, lit=True)

    def floor(self, z: float) -> None:
        """Draw a horizontal wall."""
        height = (z - self.view.centre[2]) / self.view.half
        wall = pv.Plane(center=(0.0, 0.0, height - 1e-3), i_size=8.0, j_size=8.0)
        self.plotter.add_mesh(wall, color=self.theme.solid, lighting=False)

    def image(self, eye: Sequence[float] = _EYE) -> Picture:
        """What has been drawn, (size, size, 3), seen from that direction; ends the drawing."""
        far = 20.0 * np.array(eye) / np.linalg.norm(eye)
        return _photograph(self.plotter, far.tolist(), (0.0, 0.0, 1.0), (1.0, 60.0))


def new_panel(view: View, size: int, theme: Theme = LIGHT) -> Panel:
    """An empty panel of the plane."""
    return Panel(_blank(size, theme.solid, view.aspect), view, size, theme)


def new_spatial_panel(view: View, size: int, theme: Theme) -> SpatialPanel:
    """An empty panel of space."""
    panel = SpatialPanel(_blank(size, theme.page), view, size, theme)
    panel.plotter.enable_depth_peeling(8)
    return panel


def segments(ends: Array) -> pv.PolyData:
    """Lines between points (n, 2, 3)."""
    return pv.PolyData(ends.reshape(-1, 3), lines=counted(np.arange(2 * len(ends)).reshape(-1, 2)))


def _blank(size: int, background: str, aspect: float = 1.0) -> pv.Plotter:
    """A plotter for a picture size pixels wide, `aspect` times as high, which `_photograph` ends."""
    high = SAMPLES * round(aspect * size)
    plotter = pv.Plotter(off_screen=True, window_size=[SAMPLES * size, high])
    plotter.set_background(background)
    plotter.disable_anti_aliasing()  # there are samples enough
    return plotter


def _photograph(
    plotter: pv.Plotter,
    eye: Sequence[float],
    up: Sequence[float],
    clipping: tuple[float, float],
    aspect: float = 1.0,
) -> Picture:
    """What has been drawn in [-1, 1]^3, seen from afar, each pixel the mean of its samples."""
    plotter.enable_parallel_projection()
    camera = plotter.camera
    camera.focal_point, camera.position, camera.up = (0.0, 0.0, 0.0), tuple(eye), tuple(up)
    camera.parallel_scale = aspect
    camera.clipping_range = clipping
    samples = Image.fromarray(plotter.screenshot(return_img=True))
    plotter.close()
    size = (samples.width // SAMPLES, samples.height // SAMPLES)
    return np.asarray(samples.resize(size, Image.Resampling.HAMMING))


def require_opengl() -> None:
    """Choose the kind of off-screen window that works here, for VTK in this process.

    A child process is asked, since VTK crashes where it cannot draw.

    Raises InputError: none works; the message names the missing package.
    """
    chosen = os.environ.get(_SETTING)
    for window in (chosen,) if chosen else _WINDOWS:
        if _draws(window):
            os.environ[_SETTING] = window
            return
    raise InputError(
        "render: no off-screen OpenGL on this machine; as root: apt-get install -y libegl1 libgl1, "
        "or look at the .pvd files in ParaView"
    )


def _draws(window: str) -> bool:
    """True where a child process can draw into a window of this VTK class."""
    command, environment = [sys.executable, "-c", _DRAW], os.environ | {_SETTING: window}
    try:
        child = subprocess.run(command, env=environment, capture_output=True, timeout=60, check=False)
    except subprocess.TimeoutExpired:
        return False
    return child.returncode == 0
