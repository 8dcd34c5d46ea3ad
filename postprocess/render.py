"""A picture of a run: the flow around the bodies, and the mesh in the narrowest gap."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyvista as pv
from matplotlib import colormaps
from matplotlib.colors import ListedColormap

from fsi.bodies import Configuration
from fsi.errors import InputError
from fsi.gaps import find_gaps
from meshes.geometry import Container
from postprocess.fields import cells_within, edges, mirrored, read_step, refine, stream_function
from postprocess.folder import read_case, read_configuration
from postprocess.opengl import require_opengl
from postprocess.panel import INK, Panel, Span, View

_SIZE = 1000  # pixels of each of the two square panels
_TITLE, _BAR = 0.07, 0.18  # height of the titles, width of the colour bars, in panels
_PALE = ListedColormap(colormaps["cividis"](np.linspace(0.35, 1.0, 256)))  # dark lines stay visible on it
_STREAMLINES = 24
_SLOW, _DECADES = (
    0.05,
    4.0,
)  # the slowest part of the area has one colour; most decades that have different ones
_CLOSE_UP = 12.0  # width of the close-up, in gaps
_ROOM = 1.5  # free space around the bodies, in radii of the largest


def render_run(run: Path, output: Path | None = None, time: float | None = None) -> Path:
    """Draw the step nearest to `time` (default: the last one written) into a PNG file.

    Args:
        run: the run folder.
        output: the picture, `flow.png` in the run folder if not given.
        time: in the units of the case.

    Returns:
        The path of the picture.

    Raises:
        InputError: not a run folder, no fields in it, no OpenGL here, or the picture cannot be written.
    """
    output = run / "flow.png" if output is None else output
    if output.suffix != ".png" or not output.parent.is_dir():
        raise InputError(f"output = {output}: give the path of a .png file in a folder that exists")
    case = read_case(run)
    fluid, t = read_step(run, time)
    q = read_configuration(run, t)
    require_opengl()
    if case.axisymmetric:
        fluid = mirrored(fluid)
    view = around_bodies(q, fluid)
    close_up = narrowest_gap(q, case.container(), view)
    plotter = _plotter()
    flow, mesh = Panel(plotter, 0, view), Panel(plotter, 2, close_up)
    flow.title(f"{case.name},  t = {t:.6g}:  speed and streamlines")
    _draw_flow(flow, fluid, case.axisymmetric)
    flow.frame(close_up)
    mesh.title(f"narrowest gap {find_gaps(q, case.container()).smallest():.3g}:  pressure and mesh")
    _draw_mesh(mesh, fluid)
    for panel in (flow, mesh):
        panel.bodies(q, turning=not case.axisymmetric)
        panel.finish()
    try:
        plotter.screenshot(output)
    except OSError as error:
        raise InputError(
            f"output = {output}: {error.strerror}; choose a folder that can be written"
        ) from None
    finally:
        plotter.close()
    return output


def around_bodies(q: Configuration, fluid: pv.UnstructuredGrid) -> View:
    """The square that shows all bodies with room around them and, if it can, nothing but the domain."""
    x_low, x_high, y_low, y_high = fluid.bounds[:4]
    low, high = np.array([x_low, y_low]), np.array([x_high, y_high])
    if not len(q):
        return View(0.5 * (low + high), 0.5 * float(np.max(high - low)))
    room = q.radii[:, None] + _ROOM * q.radii.max()
    body_low, body_high = (q.centres - room).min(axis=0), (q.centres + room).max(axis=0)
    half = 0.5 * min(float(np.max(body_high - body_low)), float(np.max(high - low)))
    centre = 0.5 * (body_low + body_high)
    inside = np.clip(centre, np.minimum(low + half, high - half), np.maximum(low + half, high - half))
    return View(np.where(high - low < 2.0 * half, 0.5 * (low + high), inside), half)


def narrowest_gap(q: Configuration, container: Container, around: View) -> View:
    """A close-up, smaller than the view `around`, of the smallest gap between bodies or to a wall."""
    gaps = find_gaps(q, container)
    if not _CLOSE_UP * gaps.smallest() < 2.0 * around.half:
        return around
    if gaps.pair_gaps.min(initial=np.inf) == gaps.smallest():
        i, j = gaps.pairs[np.argmin(gaps.pair_gaps)]
        towards = q.centres[j] - q.centres[i]
    else:
        i, wall = np.unravel_index(np.argmin(gaps.wall_gaps), gaps.wall_gaps.shape)
        shifts = 1e-3 * q.radii[i] * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        distances = container.distances(q.centres[i] + shifts)[:, wall]
        towards = distances[1::2] - distances[::2]
    reach = q.radii[i] + 0.5 * gaps.smallest()
    return View(q.centres[i] + reach * towards / np.linalg.norm(towards), 0.5 * _CLOSE_UP * gaps.smallest())


def _plotter() -> pv.Plotter:
    """An empty picture: titles above, two panels below, each with a place for its colour bar."""
    plotter = pv.Plotter(
        off_screen=True,
        shape=(2, 4),
        col_weights=[1.0, _BAR, 1.0, _BAR],
        row_weights=[_TITLE, 1.0],
        window_size=[round(2.0 * (1.0 + _BAR) * _SIZE), round((1.0 + _TITLE) * _SIZE)],
        border=False,
    )
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa", all_renderers=True)
    return plotter


def _cells_in(fluid: pv.UnstructuredGrid, view: View) -> pv.UnstructuredGrid:
    """The cells that a window shows, in its coordinates; `r` keeps the first of their own."""
    cells = cells_within(fluid, view.low, view.high)
    cells["r"] = cells.points[:, 0].copy()
    cells.points = view.local(cells.points)
    return cells


def _draw_flow(panel: Panel, fluid: pv.UnstructuredGrid, axisymmetric: bool) -> None:
    """Speed in colours, streamlines as level lines of the stream function: the closer, the faster."""
    cells = _cells_in(fluid, panel.view)
    surface = refine(cells)
    u = surface["velocity"]
    surface["psi"] = stream_function(surface, surface["r"][:, None] * u if axisymmetric else u)
    panel.colour(surface, "speed", "viridis", _speeds(panel, surface), log_scale=True)
    panel.lines(edges(cells), "black", width=2, opacity=min(0.25, 500.0 / cells.n_cells))
    levels = np.linspace(*panel.span(surface, "psi"), _STREAMLINES + 2)[1:-1]
    panel.lines(surface.contour(levels, scalars="psi"), "white", width=3, opacity=0.8)


def _draw_mesh(panel: Panel, fluid: pv.UnstructuredGrid) -> None:
    """The cells, over the pressure."""
    cells = _cells_in(fluid, panel.view)
    surface = refine(cells)
    panel.colour(surface, "pressure", _PALE, panel.span(surface, "pressure"))
    panel.lines(edges(cells), INK, width=3)


def _speeds(panel: Panel, surface: pv.PolyData) -> Span:
    """The speeds between which colours differ: films are far faster than the rest, walls far slower."""
    fastest = panel.span(surface, "speed")[1] or 1.0
    cells = surface.compute_cell_sizes(length=False, volume=False).point_data_to_cell_data()
    order = np.argsort(cells["speed"])
    area = np.cumsum(cells["Area"][order])
    slow = float(cells["speed"][order][np.searchsorted(area, _SLOW * area[-1])])
    return max(slow, 10.0**-_DECADES * fastest), fastest
