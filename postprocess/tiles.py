"""Fill a window with the images of a periodic flow.

A run writes one copy of the fluid, opened along its cut; pictures show whole bodies and a window of plain
sides.
"""

from __future__ import annotations

import numpy as np
import pyvista as pv

from fsi.bodies import Array, Configuration
from meshes.cell import Cell, Periodic, mean_velocity
from meshes.lattice import Integers, Lattice
from postprocess.view import View

_ROOM = 0.6  # half the width of the window over the longest side of the domain
_SAME_PLACE = 1e-9  # of the window: nodes of two copies that are one


def window(container: Periodic) -> View:
    """A square around one period of the domain; of a channel with its walls."""
    if isinstance(container, Cell):
        centre = 0.5 * container.periods.sum(axis=0)
        return View(centre, _ROOM * float(np.linalg.norm(container.periods, axis=1).max()))
    low, high = np.array(container.lower), np.array(container.upper)
    return View(0.5 * (low + high), 0.5 * float(np.max(high - low)))


def tiled(fluid: pv.UnstructuredGrid, container: Periodic, view: View) -> pv.UnstructuredGrid:
    """The images of the fluid that meet the window, in one; their velocities differ by the mean flow."""
    lattice = Lattice(container.periods)
    x_low, x_high, y_low, y_high = fluid.bounds[:4]
    copies = []
    for e in lattice.shift(_around(lattice, 0.5 * np.array([x_low + x_high, y_low + y_high]), view, fluid)):
        low, high = np.array([x_low, y_low]) + e, np.array([x_high, y_high]) + e
        if np.all(low <= view.high) and np.all(high >= view.low):
            copy = fluid.copy()
            copy.points[:, :2] += e
            copy["velocity"][:, :2] += mean_velocity(container, e)
            copies.append(copy)
    together = pv.merge(copies, merge_points=False)
    return together.clean(tolerance=_SAME_PLACE * view.half, remove_unused_points=False)


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


def _around(lattice: Lattice, centre: Array, view: View, fluid: pv.UnstructuredGrid) -> Integers:
    """The integers of all images of the fluid, which lies around `centre`, that may meet the window."""
    size = 2.0 * view.half + float(fluid.length)
    reach = int(np.ceil(size / np.linalg.norm(lattice.vectors, axis=1).min()))
    return _all_within(lattice, reach) + lattice.nearest((view.centre - centre)[None])


def _all_within(lattice: Lattice, reach: int) -> Integers:
    """All integers with |m_k| <= reach."""
    ranges = [np.arange(-reach, reach + 1)] * lattice.dimension
    return np.stack(np.meshgrid(*ranges), axis=-1).reshape(-1, lattice.dimension)
