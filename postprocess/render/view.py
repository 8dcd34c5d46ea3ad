"""What is to be seen: the user's choice, and square windows, on the plane or as cubes in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyvista as pv

from fsi.bodies.configuration import Array
from fsi.meshes.geometry.container import Container
from fsi.postprocess.render.fields import Span
from fsi.postprocess.run.gaps import SurfaceGap

_CLOSE_UP = 12.0  # width of the close-up, in gaps
_MARGIN = 1.1  # of a window around all bodies
_ROOM = 1.5  # free space around the bodies, in radii of the largest
_PERIOD = 0.6  # half the width of the window over the longest side of a periodic domain


@dataclass(frozen=True, slots=True)
class Choice:
    """What the user of `fsi render` wants to see.

    Without field and gap that is the speed, and the mesh in the narrowest gap; or the contacts; or all
    profiles.

    Attributes:
        field: what to colour.
        gap: two sides, "3,7" or "disc,bottom".
        span: of the colours.
        size: pixels of a panel.
    """

    field: str | None = None
    gap: str | None = None
    span: Span | None = None
    size: int = 1000


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A square window on the plane: its centre, shape (2,), and half its width; in space a cube."""

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
        """Points (..., 2 or 3) in the window's coordinates, those of the plane with z = 0, shape (..., 3)."""
        inside = (x[..., : len(self.centre)] - self.centre) / self.half
        above = np.zeros_like(inside[..., : 3 - len(self.centre)])
        return np.concatenate([inside, above], axis=-1)

    def close_up(self, gap: SurfaceGap) -> View:
        """A window twelve gaps wide on the gap, or this one where that is smaller."""
        half = 0.5 * _CLOSE_UP * gap.width
        return View(gap.middle, half) if half < self.half else self


def around_bodies(centres: Array, radii: Array, fluid: pv.UnstructuredGrid) -> View:
    """The square that shows all bodies with room around them and, if it can, nothing but the domain.

    centres: of all bodies (N, 2), or for a window on a whole run (steps, N, 2).
    """
    low, high = np.array(fluid.bounds[:4]).reshape(2, 2).T
    if not len(radii):
        return View(0.5 * (low + high), 0.5 * float(np.max(high - low)))
    room = radii[:, None] + _ROOM * radii.max()
    body_low = (centres - room).reshape(-1, 2).min(axis=0)
    body_high = (centres + room).reshape(-1, 2).max(axis=0)
    half = 0.5 * min(float(np.max(body_high - body_low)), float(np.max(high - low)))
    centre = 0.5 * (body_low + body_high)
    inside = np.clip(centre, np.minimum(low + half, high - half), np.maximum(low + half, high - half))
    return View(np.where(high - low < 2.0 * half, 0.5 * (low + high), inside), half)


def around_all(centres: Array, radii: Array) -> View:
    """The square, or cube, that just shows all bodies at all steps; centres: (steps, N, d)."""
    x = centres.reshape(-1, centres.shape[2])
    room = np.tile(radii, len(centres))[:, None]
    low, high = (x - room).min(axis=0), (x + room).max(axis=0)
    return View(0.5 * (low + high), _MARGIN * 0.5 * float(np.max(high - low)))


def around_period(container: Container) -> View:
    """A square around one period of a periodic domain; of a channel with its walls."""
    longest = float(np.linalg.norm(container.periods, axis=1).max())
    half = 0.5 * max(longest, container.volume / longest) if container.walls else _PERIOD * longest
    return View(container.middle, half)
