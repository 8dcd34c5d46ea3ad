"""What a window on the plane shows of a step: fluid and bodies, mirrored or repeated as the case asks.

A periodic run writes one copy of the fluid, opened along its cut; pictures show whole bodies and a window of
plain sides, which is filled with images.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.bodies.configuration import Configuration
from fsi.bodies.surface_gap import SurfaceGap, gap_between, narrowest_gap
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice
from fsi.postprocess.render.curved_cells import cells_within, mirrored, refine, stream_function
from fsi.postprocess.render.fields import DISTURBANCE, RenderedField
from fsi.postprocess.render.mean_flow import UndisturbedFlow, undisturbed
from fsi.postprocess.render.view import View, around_bodies, around_period
from fsi.postprocess.run.grids import nodes
from fsi.postprocess.run.probe import mean_pressure_gradient
from fsi.postprocess.run.run import Run

_SIDE = 12.0  # of the triangles that stand for a cell, in pixels; the colours between are linear
_OF_ORDER_4 = 15  # nodes of a cell
_PSI = {"velocity": "psi", DISTURBANCE: "psi of the disturbance"}  # the stream function of each flow
RIBBON = 0.05  # width of what shows, inside bodies, what these carry, in halves of the window
_SAME_PLACE = 1e-9  # of the window: nodes of two copies that are one


@dataclass(frozen=True)
class Scene:
    """The flow of one step, as one window shows it.

    Attributes:
        view: the window.
        fluid: the cells in it, in its coordinates, with the data of the run and `r`, the first of their own.
        bodies: the surfaces of the bodies, in the window's coordinates; None where they are not wanted.
        q: the bodies that it shows.
        axisymmetric: whether it is mirrored at an axis.
        viscosity: mu.
    """

    view: View
    fluid: pv.UnstructuredGrid
    bodies: pv.UnstructuredGrid | None
    q: Configuration
    axisymmetric: bool
    viscosity: float

    def surface(self, field: RenderedField, size: int) -> pv.PolyData:
        """Triangles small enough for so many pixels, with the data `value`, and `psi` for streamlines."""
        psi = _PSI.get(field.streamlines)
        if psi is not None and psi not in self.fluid.point_data:
            u = self.fluid[field.streamlines]
            w = self.fluid["r"][:, None] * u if self.axisymmetric else u
            self.fluid[psi] = stream_function(self.fluid, w)
        surface = self.bare_surface(size, [*field.needs, *([psi] if psi else [])])
        if psi is not None:
            surface["psi"] = surface[psi]
        surface["value"] = field.value(surface.point_data, self.viscosity)
        return surface

    def bare_surface(self, size: int, names: Sequence[str] = ()) -> pv.PolyData:
        """Such triangles with the named data."""
        return refine(self.fluid, names, _SIDE * 2.0 / size)

    def samples(self, field: RenderedField) -> tuple[Array, Array]:
        """Values of a field in the window, or anywhere if it shows none, and the area that each stands for.

        They are the means in cells, as if their sides were straight; where all values count, or on bodies,
        they are those at the nodes, with equal weights. The nodes of cells of order 4 and more, which are few
        and large, stand for parts of them.
        """
        grid = self.bodies if field.on_bodies else self.fluid
        if grid is None:
            return np.ones(1), np.ones(1)
        x, value = np.asarray(grid.points), np.asarray(field.value(grid.point_data, self.viscosity))
        weight = np.ones(len(value))
        if not (field.on_bodies or field.scale.whole):
            cells = nodes(grid)
            a, b, c = x[cells[:, :3].T, :2]
            weight = 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
            if cells.shape[1] >= _OF_ORDER_4:
                weight = np.repeat(weight / cells.shape[1], cells.shape[1])
                x, value = x[cells.ravel()], value[cells.ravel()]
            else:
                x, value = (a + b + c) / 3.0, value[cells].mean(axis=1)
        seen = in_window(x, self.view)
        return value[seen], weight[seen]


def in_window(x: Array, view: View) -> NDArray[np.bool_]:
    """Which of points in a window's coordinates (n, ...) it shows; all if it shows none."""
    seen = view.shows(x)
    return seen if seen.any() else ~seen


def window_on(run: Run, steps: Sequence[int], fluid: pv.UnstructuredGrid) -> View:
    """One window on the bodies of all those steps, fluid being that of the first; or on one period."""
    container = run.container(steps[0])
    if len(container.periods):
        return around_period(container)
    q = [run.configuration(step) for step in steps]
    fluid = mirrored(fluid) if run.case.axisymmetric else fluid
    return around_bodies(np.stack([at.centres for at in q]), q[0].radii, fluid)


def gap_at(run: Run, step: int, sides: tuple[int, int] | None, window: View) -> SurfaceGap:
    """The gap between those sides, or the narrowest; of its images that next to the window's middle.

    It is as the mesh has it.
    """
    container = run.container(step)
    if sides is None:
        narrowest = narrowest_gap(run.configuration(step), container)
        assert narrowest is not None  # there are fields: the fluid has walls or periods
        gap = gap_between(run.meshed(step), container, narrowest.sides, narrowest.away)
    else:
        gap = gap_between(run.meshed(step), container, sides)
    lattice = Lattice(container.periods)
    away = lattice.shift(lattice.nearest((gap.middle - window.centre)[None]))[0]
    return replace(gap, middle=gap.middle - away)


def scene(run: Run, step: int, fluid: pv.UnstructuredGrid, view: View, tractions: bool) -> Scene:
    """What a window shows of a step with that fluid, with all fields that can be coloured.

    tractions: whether to read the surfaces of the bodies, which carry them.
    """
    q, container, axisymmetric = run.meshed(step), run.container(step), run.case.axisymmetric
    bodies = run.mesh(step, "surface") if tractions else None
    if axisymmetric:
        fluid, bodies = mirrored(fluid), None if bodies is None else mirrored(bodies)
    lattice = Lattice(container.periods)
    # A surface out of sight may have its ribbon, inside its body, in sight.
    wider = replace(view, half=(1.0 + RIBBON / view.aspect) * view.half)
    if lattice.dimension:
        cells, (q, _) = tiled(fluid, container, view), images(q, container, view)
        bodies = None if bodies is None else tiled(bodies, container, wider)
    else:
        cells = cells_within(fluid, view.low, view.high)
        bodies = None if bodies is None else cells_within(bodies, wider.low, wider.high)
    if "velocity" in cells.point_data and (flow := undisturbed(run, step)) is not None:
        x = np.asarray(cells.points, dtype=float)
        cells[DISTURBANCE] = cells["velocity"] - flow.at(x)
        if "psi" in cells.point_data:  # pores know it themselves
            cells[_PSI[DISTURBANCE]] = cells["psi"] - flow.stream_function(x)
    cells["r"] = cells.points[:, 0].copy()
    cells.points = view.local(cells.points)
    if bodies is not None:
        bodies, here = bodies.copy(), run.meshed(step)
        # The centre of the body, or of its image, that each cell belongs to, (cells, 2).
        body, x = bodies.cell_data["body"], bodies.cell_centers().points[:, :2]
        centre = here.centres[body] + here.to_images(lattice, body, x)
        bodies.cell_data["inside"], bodies.points = view.local(centre), view.local(bodies.points)
    return Scene(view, cells, bodies, q, axisymmetric, run.case.fluid.viscosity)


def tiled(grid: pv.UnstructuredGrid, container: Container, view: View) -> pv.UnstructuredGrid:
    """The cells of all images of the fluid, or of surfaces, that meet the window, in one grid.

    Their velocities and stream functions differ by those of the mean flow, their pressures by that of the
    mean gradient.
    """
    lattice = Lattice(container.periods)
    low, high = np.array(grid.bounds[:4]).reshape(2, 2).T
    G = mean_pressure_gradient(grid, lattice) if "pressure" in grid.point_data else np.zeros(2)
    psi = UndisturbedFlow(np.zeros(2), container.mean_gradient).stream_function
    copies = []
    for m in _near(lattice, 0.5 * (low + high), view, float(grid.length)):
        e = lattice.shift(m)
        if np.all(low + e <= view.high) and np.all(high + e >= view.low):
            copy = cells_within(grid, view.low - e, view.high - e)
            copy.points[:, :2] += e
            if "velocity" in copy.point_data:
                copy["velocity"][:, :2] += container.mean_velocity(e)
            if "pressure" in copy.point_data:
                copy["pressure"] += e @ G
            if "psi" in copy.point_data:
                x = np.asarray(copy.points)[:, :2]
                copy["psi"] += psi(x) - psi(x - e)
            copies.append(copy)
    together = pv.merge(copies, merge_points=False)
    # VTK takes what pyvista calls a distance for a part of the size of all.
    return together.clean(tolerance=_SAME_PLACE * view.half / together.length, remove_unused_points=False)


def images(q: Configuration, container: Container, view: View) -> tuple[Configuration, NDArray[np.int64]]:
    """The images of the bodies that meet the window, and of which body each is, (n,)."""
    lattice = Lattice(container.periods)
    shifts = lattice.shift(_near(lattice, np.zeros(2), view, 2.0 * lattice.longest()))
    centres = (shifts[:, None] + lattice.wrapped(q.centres)).reshape(-1, 2)
    angles, radii = np.tile(q.angles, len(shifts)), np.tile(q.radii, len(shifts))
    seen = np.all(np.abs(centres - view.centre) <= view.reach + radii[:, None], axis=1)
    outlines = tuple(outline for outline, so in zip(q.outlines * len(shifts), seen, strict=False) if so)
    which = np.flatnonzero(seen) % len(q)
    return Configuration(centres[seen], angles[seen], radii[seen], outlines), which


def _near(lattice: Lattice, centre: Array, view: View, length: float) -> Indices:
    """The integers of all images of what is so long, around `centre`, that may meet the window."""
    reach = int(np.ceil((2.0 * view.half + length) / np.linalg.norm(lattice.vectors, axis=1).min()))
    ranges = [np.arange(-reach, reach + 1)] * lattice.dimension
    within = np.stack(np.meshgrid(*ranges), axis=-1).reshape(-1, lattice.dimension)
    return within + lattice.nearest((view.centre - centre)[None])
