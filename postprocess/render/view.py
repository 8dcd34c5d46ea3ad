"""What is to be seen: the user's choice, and windows, on the plane or as cubes in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.surface_gap import SurfaceGap
from fsi.meshes.geometry.container import Container
from fsi.postprocess.plots.figure import DARK, LIGHT, Theme
from fsi.postprocess.render.scales import Span

_CLOSE_UP = 12.0  # width of the close-up, in gaps
_STRIP = 0.4  # height of the close-up over its width: films are long
_FILLED = 0.8  # most of that height that a gap takes, so that the surfaces on both sides are seen
_ZOOM = 2.0  # least width of a window over that of a close-up in it
_MARGIN = 1.1  # of a window around all bodies
_ROOM = 1.5  # free space around the bodies, in radii of the largest
_PERIOD = 0.6  # half the width of the window over the longest side of a periodic domain
_WALLS = 1.14  # height of the window over that of a channel: its walls are seen, and how they move
_FLATTEST = 0.3  # least height of a window over its width


@dataclass(frozen=True, slots=True)
class Choice:
    """What the user of `fsi render` wants to see.

    Without field and gap that is the speed, and the mesh in the narrowest gap; or the contacts; or all
    profiles.

    Attributes:
        field: what to colour.
        gap: two sides, "3,7" or "disc,bottom".
        span: of the colours.
        size: pixels of a panel's width.
        plane: in space, which plane is shown, "x=0.5", "y=0" or "z=1".
        revolved: whether to show an axisymmetric flow in space.
        dark: whether the page is dark.
    """

    field: str | None = None
    gap: str | None = None
    span: Span | None = None
    size: int = 1000
    plane: str | None = None
    revolved: bool = False
    dark: bool = False

    @property
    def theme(self) -> Theme:
        """The colours of the page."""
        return DARK if self.dark else LIGHT


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A window on the plane; in space a cube.

    Attributes:
        centre: its middle, (2,), in space (3,).
        half: half its width.
        aspect: its height over its width.
        up: the unit vector of the plane that points upwards in the picture.
    """

    centre: Array
    half: float
    aspect: float = 1.0
    up: tuple[float, float] = (0.0, 1.0)

    @property
    def sides(self) -> Array:
        """From the centre to the middles of the right and the upper side, (2, 2)."""
        x, y = self.up
        return self.half * np.array([[y, -x], [self.aspect * x, self.aspect * y]])

    @property
    def reach(self) -> Array:
        """Half the sides, along x and y, of the smallest upright rectangle that holds it, (2,)."""
        reach: Array = np.abs(self.sides).sum(axis=0)
        return reach

    @property
    def low(self) -> Array:
        """Lower left corner of that rectangle."""
        return self.centre - self.reach

    @property
    def high(self) -> Array:
        """Upper right corner of that rectangle."""
        return self.centre + self.reach

    @property
    def turned(self) -> float:
        """By how many degrees the picture is turned, counterclockwise."""
        return float(np.degrees(np.arctan2(*self.up)))

    def shows(self, local: Array) -> NDArray[np.bool_]:
        """Which of points in its coordinates (n, 2 or 3) it shows, (n,)."""
        along = local[:, :2] @ (self.sides / self.half).T
        shown: NDArray[np.bool_] = np.all(np.abs(along) <= [1.0, self.aspect**2], axis=1)
        return shown

    def local(self, x: Array) -> Array:
        """Points (..., 2 or 3) in the window's coordinates, those of the plane with z = 0, shape (..., 3)."""
        inside = (x[..., : len(self.centre)] - self.centre) / self.half
        above = np.zeros_like(inside[..., : 3 - len(self.centre)])
        return np.concatenate([inside, above], axis=-1)

    def close_up(self, gap: SurfaceGap) -> View:
        """A window on the gap: in the plane a strip along the film, turned until that lies flat.

        It is twelve gaps wide, or half as wide as this window where that is smaller, unless both surfaces are
        seen in a wider one only. In space it is a cube, or this one where that is smaller.
        """
        half = 0.5 * _CLOSE_UP * gap.width
        if len(self.centre) == 3:
            return View(gap.middle, half) if half < self.half else self
        x, y = (gap.normal if gap.normal[1] >= 0.0 else -gap.normal).tolist()
        return View(gap.middle, min(half, max(self._closest, _least(gap))), _STRIP, (x, y))

    def is_narrow(self, gap: SurfaceGap) -> bool:
        """Whether half of this window is wide enough for a close-up of the gap with both its surfaces."""
        return _least(gap) <= self._closest

    @property
    def _closest(self) -> float:
        """Half the width of what is seen closer than in this window, at most."""
        return self.half / _ZOOM


def _least(gap: SurfaceGap) -> float:
    """Half the width of the smallest close-up that has both surfaces of a gap in it."""
    return 0.5 * gap.width / (_STRIP * _FILLED)


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
    """The window, or cube, that just shows all bodies at all steps; centres: (steps, N, d)."""
    x = centres.reshape(-1, centres.shape[2])
    room = np.tile(radii, len(centres))[:, None]
    low, high = (x - room).min(axis=0), (x + room).max(axis=0)
    half, aspect = _MARGIN * 0.5 * float(np.max(high - low)), 1.0
    if x.shape[1] == 2 and high[0] - low[0] > high[1] - low[1]:
        aspect = max(_FLATTEST, float((high[1] - low[1]) / (high[0] - low[0])))
    return View(0.5 * (low + high), half, aspect)


def around_period(container: Container) -> View:
    """A window around one period of a periodic domain; of a channel with its walls."""
    longest = float(np.linalg.norm(container.periods, axis=1).max())
    if not container.walls:
        return View(container.middle, _PERIOD * longest)
    height = _WALLS * container.volume / longest
    half = 0.5 * max(longest, height)
    return View(container.middle, half, max(_FLATTEST, min(1.0, 0.5 * height / half)))
