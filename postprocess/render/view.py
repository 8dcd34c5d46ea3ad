"""Square windows on the plane: around all bodies, or close up to a gap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyvista as pv

from fsi.bodies.configuration import Array, Configuration
from fsi.bodies.gaps import find_gaps
from fsi.errors import InputError
from fsi.meshes.geometry.containers import Container
from fsi.meshes.geometry.lattice import Lattice

_CLOSE_UP = 12.0  # width of the close-up, in gaps
_MARGIN = 1.1  # of a window around all bodies
_ROOM = 1.5  # free space around the bodies, in radii of the largest


@dataclass(frozen=True, slots=True)
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
        """Points (..., 2) of the plane in the window's coordinates, with z = 0, shape (..., 3)."""
        inside = (x[..., :2] - self.centre) / self.half
        return np.concatenate([inside, np.zeros_like(inside[..., :1])], axis=-1)


@dataclass(frozen=True, slots=True)
class Gap:
    """A gap: its width, its middle (2,), and what lies on both sides, numbers of bodies and then walls."""

    width: float
    middle: Array
    sides: tuple[int, int]

    def close_up(self, around: View) -> View:
        """A window twelve gaps wide on it, or `around` where that is smaller."""
        half = 0.5 * _CLOSE_UP * self.width
        return View(self.middle, half) if half < around.half else around

    def moved(self, by: Array) -> Gap:
        """Its image that lies so far away."""
        return Gap(self.width, self.middle + by, self.sides)


def around_bodies(centres: Array, radii: Array, fluid: pv.UnstructuredGrid) -> View:
    """The square that shows all bodies with room around them and, if it can, nothing but the domain.

    centres: of all bodies (N, 2), or for a window on a whole run (steps, N, 2).
    """
    x_low, x_high, y_low, y_high = fluid.bounds[:4]
    low, high = np.array([x_low, y_low]), np.array([x_high, y_high])
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


def narrowest_gap(q: Configuration, container: Container) -> Gap:
    """The smallest of all gaps between bodies or to a wall."""
    gaps = find_gaps(q, container)
    if gaps.pair_gaps.min(initial=np.inf) == gaps.smallest():
        pair = np.argmin(gaps.pair_gaps)
        i, j = gaps.pairs[pair]
        return gap_between(q, container, (int(i), int(j)), gaps.away[pair])
    i, wall = np.unravel_index(np.argmin(gaps.wall_gaps), gaps.wall_gaps.shape)
    return gap_between(q, container, (int(i), len(q) + int(wall)))


def gap_between(
    q: Configuration, container: Container, sides: tuple[int, int], away: Array | None = None
) -> Gap:
    """The gap of body `sides[0]` to another body, or to the wall of number `sides[1] - len(q)`.

    away: how far the image of the other body that is meant lies from it; if not given, the nearest is.
    """
    i, j = sides
    if j < len(q):
        towards = q.centres[j] - q.centres[i]
        lattice = Lattice(container.periods)
        towards = towards + (-lattice.shift(lattice.nearest(towards[None]))[0] if away is None else away)
        width = float(np.linalg.norm(towards)) - q.radii[i] - q.radii[j]
    else:
        wall = j - len(q)
        shifts = 1e-3 * q.radii[i] * np.kron(np.eye(q.centres.shape[1]), [[1.0], [-1.0]])
        distances = container.distances(q.centres[i] + shifts)[:, wall]
        towards = distances[1::2] - distances[::2]
        width = float(container.distances(q.centres[i : i + 1])[0, wall]) - q.radii[i]
    reach = q.radii[i] + 0.5 * width
    return Gap(float(width), q.centres[i] + reach * towards / np.linalg.norm(towards), sides)


def parse_sides(text: str, names: tuple[str, ...], walls: tuple[str, ...]) -> tuple[int, int]:
    """The sides of a gap in "3,7" or "disc,bottom": names, or numbers of bodies from 0. Raises InputError."""
    known = [*names, *walls]
    sides = []
    for word in (word.strip() for word in text.split(",")):
        if word in known:
            sides.append(known.index(word))
        elif word.isdigit() and int(word) < len(names):
            sides.append(int(word))
        else:
            raise InputError(f"--gap {text}: there is no {word!r}; give two of {_listed(names, walls)}")
    sides.sort()
    if len(sides) != 2 or sides[0] == sides[1] or sides[0] >= len(names):
        raise InputError(f"--gap {text}: give a body and another body or wall, of {_listed(names, walls)}")
    return sides[0], sides[1]


def _listed(names: tuple[str, ...], walls: tuple[str, ...]) -> str:
    """The names that may be given."""
    bodies = [*names] if len(names) <= 6 else [names[0], "...", names[-1]]
    return f"{', '.join([*bodies, *walls])}, or 0 ... {len(names) - 1} for the bodies"
