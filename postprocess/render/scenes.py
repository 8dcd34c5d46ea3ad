"""What a window on the plane shows of a step: fluid and bodies, mirrored or repeated as the case asks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyvista as pv

from fsi.bodies.configuration import Array, Configuration
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.geometry.periodic import Cell, Channel
from fsi.postprocess.render.curved_cells import cells_within, mirrored, refine
from fsi.postprocess.render.tiles import images, tiled, window
from fsi.postprocess.render.view import Gap, View, around_bodies, gap_between, narrowest_gap
from fsi.postprocess.run.run import Run

MADE_OF = {"speed": "velocity", "dissipation": "strain_rate"}  # and not interpolated themselves
_SIDE = 12.0  # of the triangles that stand for a cell, in pixels; the colours between are linear


@dataclass(frozen=True)
class Scene:
    """The flow of one step, as one window shows it.

    fluid: its cells there, in the window's coordinates, with point data `r`, the first of their own, and what
    `derive` adds; bodies: surfaces of the bodies, in the window's coordinates, or None.
    """

    view: View
    fluid: pv.UnstructuredGrid
    bodies: pv.UnstructuredGrid | None
    q: Configuration
    axisymmetric: bool
    viscosity: float

    def surface(self, names: Sequence[str], size: int) -> pv.PolyData:
        """Triangles small enough for so many pixels, with the named data."""
        surface = refine(self.fluid, [MADE_OF.get(name, name) for name in names], _SIDE * 2.0 / size)
        derive(surface, self.viscosity)
        return surface


def derive(grid: pv.DataSet, viscosity: float) -> None:
    """Add `speed` where there are velocities, `dissipation` where there are strain rates."""
    if "velocity" in grid.point_data:
        grid["speed"] = np.linalg.norm(grid["velocity"], axis=1)
    if "strain_rate" in grid.point_data:
        grid["dissipation"] = viscosity * np.square(grid["strain_rate"])


def window_on(run: Run, steps: Sequence[int], fluid: pv.UnstructuredGrid) -> View:
    """One window on the bodies of all those steps, fluid being that of the first; or on one period."""
    container = run.container(steps[0])
    if isinstance(container, Channel | Cell):
        return window(container)
    q = [run.configuration(step) for step in steps]
    fluid = mirrored(fluid) if run.case.axisymmetric else fluid
    return around_bodies(np.stack([at.centres for at in q]), q[0].radii, fluid)


def gap_at(run: Run, step: int, sides: tuple[int, int] | None, around: View) -> Gap:
    """The gap between those sides, or the narrowest; of its images that next to the window's middle."""
    q, container = run.configuration(step), run.container(step)
    gap = narrowest_gap(q, container) if sides is None else gap_between(q, container, sides)
    lattice = Lattice(container.periods)
    return gap.moved(-lattice.shift(lattice.nearest((gap.middle - around.centre)[None]))[0])


def scene(run: Run, step: int, fluid: pv.UnstructuredGrid, view: View, tractions: bool) -> Scene:
    """What a window shows of a step with that fluid, with all fields that can be coloured.

    tractions: whether to read the surfaces of the bodies, which carry them.
    """
    q, container, axisymmetric = run.configuration(step), run.container(step), run.case.axisymmetric
    bodies = run.mesh(step, "surface") if tractions else None
    if axisymmetric:
        fluid, bodies = mirrored(fluid), None if bodies is None else mirrored(bodies)
    lattice, home = Lattice(container.periods), q.centres
    if isinstance(container, Channel | Cell):
        cells, q = tiled(fluid, container, view), images(q, container, view)
        bodies = None if bodies is None else tiled(bodies, container, view)
    else:
        cells = cells_within(fluid, view.low, view.high)
    cells["r"] = cells.points[:, 0].copy()
    cells.points = view.local(cells.points)
    derive(cells, run.case.fluid.viscosity)
    if bodies is not None:
        bodies = bodies.copy()
        bodies.cell_data["inside"] = view.local(_owners(bodies, home, lattice))
        bodies.points = view.local(bodies.points)
        bodies["traction size"] = np.linalg.norm(bodies["traction"], axis=1)
    return Scene(view, cells, bodies, q, axisymmetric, run.case.fluid.viscosity)


def _owners(bodies: pv.UnstructuredGrid, centres: Array, lattice: Lattice) -> Array:
    """The centre of the body, or of its image, that each cell of the surfaces belongs to, (cells, 2)."""
    centre = centres[bodies.cell_data["body"]]
    away = bodies.cell_centers().points[:, :2] - centre
    owner: Array = centre + lattice.shift(lattice.nearest(away))
    return owner
