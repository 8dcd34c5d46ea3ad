"""Draw bodies in a cell given by its lattice vectors: one of each inside, their images pale around them."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.patches import Circle, Polygon

from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.geometry.periodic import Cell
from fsi.postprocess.render.arrangement import BODY, EDGE, FRAME, IMAGE, IMAGE_EDGE


def draw_oblique(axes: Axes, container: Cell, q: Configuration) -> None:
    """The bodies at q (wrapped into the cell), the nearest images of all, and the cell, dashed."""
    lattice = Lattice(container.periods)
    home, (a, b) = lattice.wrapped(q.centres), container.periods
    corners = np.array([np.zeros(2), a, a + b, b])
    low, high = corners.min(axis=0) - q.radii.max(), corners.max(axis=0) + q.radii.max()
    for e in lattice.shift(lattice.near())[::-1]:
        here = int(not e.any())
        circles = [Circle((x, y), r) for (x, y), r in zip(home + e, q.radii, strict=True)]
        face, edge = (BODY, EDGE) if here else (IMAGE, IMAGE_EDGE)
        drawn = PatchCollection(circles, facecolors=face, edgecolors=edge, linewidths=0.7, zorder=1 + here)
        axes.add_collection(drawn)
    axes.add_patch(Polygon(corners, closed=True, fill=False, ls="--", lw=0.9, ec=FRAME, zorder=4))
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.set_axis_off()


def size(container: Cell) -> tuple[float, float]:
    """Of the figure, inches."""
    sides = np.abs(container.periods).sum(axis=0)
    width, height = 8.0 * sides / sides.max()
    return float(width) + 0.3, float(height) + 0.7
