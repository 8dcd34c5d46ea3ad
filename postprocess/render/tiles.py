"""Fill a window with the images of a periodic flow.

A run writes one copy of the fluid, opened along its cut; pictures show whole bodies and a window of plain
sides.
"""

from __future__ import annotations

import numpy as np
import pyvista as pv
from scipy.spatial import cKDTree

from fsi.bodies.configuration import Array, Configuration
from fsi.meshes.geometry.lattice import Integers, Lattice
from fsi.meshes.geometry.periodic import Cell, Channel, Periodic
from fsi.postprocess.render.curved_cells import cells_within, nodes
from fsi.postprocess.render.view import View

_ROOM = 0.6  # half the width of the window over the longest side of the domain
_SAME_PLACE = 1e-9  # of the window: nodes of two copies that are one


def window(container: Periodic) -> View:
    """A square around one period of the domain; of a channel with its walls."""
    if isinstance(container, Cell):
        centre = 0.5 * container.periods.sum(axis=0)
        return View(centre, _ROOM * float(np.linalg.norm(container.periods, axis=1).max()))
    low, high = np.array(container.lower), np.array(container.upper)
    return View(0.5 * (low + high), 0.5 * float(np.max(high - low)))


def tiled(grid: pv.UnstructuredGrid, container: Periodic, view: View) -> pv.UnstructuredGrid:
    """The cells of all images of the fluid, or of surfaces, that meet the window, in one grid.

    Their velocities differ by the mean flow, their pressures by that of the mean gradient along a channel.
    """
    lattice = Lattice(container.periods)
    low, high = np.array(grid.bounds[:4:2]), np.array(grid.bounds[1:4:2])
    rise = _rise(grid, container.periods[0]) if isinstance(container, Channel) else 0.0
    copies = []
    for m in _around(lattice, 0.5 * (low + high), view, grid):
        e = lattice.shift(m)
        if np.all(low + e <= view.high) and np.all(high + e >= view.low):
            copy = cells_within(grid, view.low - e, view.high - e)
            copy.points[:, :2] += e
            if "velocity" in copy.point_data:
                copy["velocity"][:, :2] += container.mean_velocity(e)
            if rise:
                copy["pressure"] += rise * m[0]
            copies.append(copy)
    together = pv.merge(copies, merge_points=False)
    return together.clean(tolerance=_SAME_PLACE * view.half, remove_unused_points=False)


def _rise(grid: pv.UnstructuredGrid, e: Array) -> float:
    """By how much the pressure rises over a period e: from each vertex of the cut to its image."""
    if "pressure" not in grid.point_data:
        return 0.0
    vertices = np.unique(nodes(grid)[:, :3])
    x, p = np.asarray(grid.points)[vertices, :2], np.asarray(grid["pressure"])[vertices]
    distance, image = cKDTree(x).query(x + e, distance_upper_bound=_SAME_PLACE * grid.length)
    there = np.isfinite(distance)
    return float(np.mean(p[image[there]] - p[there]))


def images(q: Configuration, container: Periodic, view: View) -> Configuration:
    """The images of the bodies that meet the window."""
    lattice = Lattice(container.periods)
    home = lattice.wrapped(q.centres)
    reach = int(np.ceil(2.0 * view.half / np.linalg.norm(lattice.vectors, axis=1).min())) + 1
    shifts = lattice.shift(_all_within(lattice, reach))
    centres = (shifts[:, None] + home).reshape(-1, 2)
    angles, radii = np.tile(q.angles, len(shifts)), np.tile(q.radii, len(shifts))
    seen = np.all(np.abs(centres - view.centre) <= view.half + radii[:, None], axis=1)
    return Configuration(centres[seen], angles[seen], radii[seen])


def _around(lattice: Lattice, centre: Array, view: View, grid: pv.UnstructuredGrid) -> Integers:
    """The integers of all images of a grid, which lies around `centre`, that may meet the window."""
    size = 2.0 * view.half + float(grid.length)
    reach = int(np.ceil(size / np.linalg.norm(lattice.vectors, axis=1).min()))
    return _all_within(lattice, reach) + lattice.nearest((view.centre - centre)[None])


def _all_within(lattice: Lattice, reach: int) -> Integers:
    """All integers with |m_k| <= reach."""
    ranges = [np.arange(-reach, reach + 1)] * lattice.dimension
    return np.stack(np.meshgrid(*ranges), axis=-1).reshape(-1, lattice.dimension)
