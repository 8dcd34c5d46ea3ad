"""Polygons that stand for bodies in a window on the plane.

In a close-up of a narrow gap bodies reach millions of windows far, where single precision, which graphics
works in, is as coarse as the window. Their polygons are fine where they come near, and are cut off around it.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pyvista as pv
from matplotlib.path import Path
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.outline import Outline
from fsi.meshes.geometry.placed import Placed
from fsi.postprocess.render.view import View
from fsi.postprocess.run.grids import Indices

_FEWEST_SIDES, _MOST_SIDES = 64, 4000  # of a body
_MANY, _FEWEST_OF_MANY = 1000, 12  # of so many discs each is some pixels wide
_FAR = 10.0  # radius over half the window, from which on a polygon is cut
_CUT = Bbox([[-4.0, -4.0], [4.0, 4.0]])  # there, in the window's coordinates
_NEAREST, _CLOSER = 1e-3, 1.1  # first side, over half the window, and how much longer each next one is


def body_polygons(q: Configuration, seen: NDArray[np.bool_], view: View, size: int) -> list[Array]:
    """The bodies that are `seen` (N,) as polygons (n, 3) in the window's coordinates; size: its pixels."""
    centres, radii = q.centres[seen], q.radii[seen]
    # The sagitta of a side is a tenth of a pixel.
    sides = np.pi * np.sqrt(radii.max() / view.half * size / 0.4)
    fewest = _FEWEST_SIDES if len(radii) < _MANY else _FEWEST_OF_MANY
    turn = np.linspace(0.0, 2.0 * np.pi, int(np.clip(sides, fewest, _MOST_SIDES)), endpoint=False)
    rims = centres[:, None] + radii[:, None, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    if q.outlines:
        rims = np.stack([q.placed[i].drawn(_MOST_SIDES) for i in np.flatnonzero(seen)])
    polygons = list(view.local(rims))
    for k in np.flatnonzero(radii > _FAR * view.half):
        i = np.flatnonzero(seen)[k]
        body = q.placed[i] if q.outlines else Placed(Outline.disc(q.radii[i]), q.centres[i], 0.0)
        polygons[k] = _cut_around(body, view)
    return polygons


def _cut_around(body: Placed, view: View) -> Array:
    """A large body next to a window, as a polygon (n, 3) that may be empty."""
    first = _NEAREST * view.half / (2.0 * np.pi * body.outline.radius)
    apart = np.geomspace(first, 0.5, int(np.log(0.5 / first) / np.log(_CLOSER)))
    nearest = body.nearest(view.centre[None])
    t = np.unique(np.concatenate([np.linspace(-0.5, 0.5, _MOST_SIDES), -apart, [0.0], apart]))[:-1]
    x = view.local(body.at(nearest + t).x)
    corners = np.asarray(Path(x[:, :2]).clip_to_bbox(_CUT).vertices)[:-1]  # the last is the first
    return np.pad(corners, ((0, 0), (0, 1)))


def filled(polygons: Sequence[Array]) -> pv.PolyData:
    """Polygons (n, 3) as a surface."""
    return pv.PolyData(np.concatenate(polygons), faces=_listed(_numbered(polygons)))


def outlined(polygons: Sequence[Array]) -> pv.PolyData:
    """Their outlines."""
    closed = [np.append(corners, corners[:1]) for corners in _numbered(polygons)]
    return pv.PolyData(np.concatenate(polygons), lines=_listed(closed))


def _numbered(polygons: Sequence[Array]) -> list[Indices]:
    """The corners of each polygon by their numbers, which count on from polygon to polygon."""
    ends = np.cumsum([0, *(len(corners) for corners in polygons)])
    return [np.arange(start, end) for start, end in pairwise(ends)]


def _listed(cells: Sequence[Indices]) -> Indices:
    """VTK's list of the cells that have corners: each led by how many."""
    none = np.empty(0, dtype=np.int64)
    return np.concatenate([none, *(np.insert(cell, 0, len(cell)) for cell in cells if len(cell))])
