"""Walls as pictures of the plane show them: what lies inside them, and which of them are open.

A panel is wall where nothing has been drawn on it. Beyond an open wall there is none: there the page is seen,
beside the ends of solid walls too, and a dashed line along the open wall.
"""

from collections.abc import Callable

import numpy as np
import pyvista as pv

from fsi.arrays import Array
from fsi.postprocess.render.canvas import Panel
from fsi.postprocess.render.view import View
from fsi.postprocess.run.run import Run

_FINE = 400  # cells across the window
_DASH = 0.03  # of half the window
_ROUNDING = 1e-6  # of the size of the domain, in the single precision of graphics

type Places = Callable[[Array], Array]  # where in the domain points (n, 2) in the window's coordinates are


def inside_walls(run: Run, view: View) -> pv.PolyData:
    """What a window shows of a container, in its coordinates."""
    plane = _window(view)
    distances = run.wall_distances(view.centre + view.half * np.asarray(plane.points[:, :2], dtype=float))
    if not distances.size:
        return plane
    plane["distance"] = distances.min(axis=1)
    inside: pv.PolyData = plane.clip_scalar(scalars="distance", invert=False, value=0.0)
    return inside


def draw_open_walls(panel: Panel, run: Run, places: Places | None = None) -> None:
    """Draw the page beyond open walls, and dashed lines along these; places: of a plane in space."""
    container, view = run.case.container(), panel.view
    opened = [name in run.case.wall_pressure() for name in container.walls]
    if not any(opened):
        return

    def distances(points: pv.DataSet) -> Array:
        local = np.asarray(points.points[:, :2], dtype=float)
        x = view.centre + view.half * local if places is None else places(local)
        if container.axisymmetric:
            x[:, 0] = np.abs(x[:, 0])
        return container.distances(x)

    plane = _window(view)
    at = distances(plane)
    plane["open"] = at[:, opened].min(axis=1)
    panel.fill(plane.clip_scalar(scalars="open", value=0.0), panel.theme.page)
    for k in np.flatnonzero(opened):
        plane["wall"] = at[:, k]
        line = plane.contour([0.0], scalars="wall")
        middles = line.cell_centers()
        seen = np.all(distances(middles) > -_ROUNDING * container.size(), axis=1)
        dashed = np.floor(np.asarray(middles.points).sum(axis=1) / _DASH) % 2 == 0
        dashes = line.extract_cells(seen & dashed).extract_surface(algorithm="dataset_surface")
        panel.lines(dashes, panel.theme.ink, width=2)


def _window(view: View) -> pv.PolyData:
    """Small rectangles that cover a window, in its coordinates."""
    wide, high = view.reach / view.half
    fine = max(2, round(_FINE * high / wide))
    return pv.Plane(i_size=2.0 * wide, j_size=2.0 * high, i_resolution=_FINE, j_resolution=fine)
