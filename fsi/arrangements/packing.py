"""Random arrangements at a given area fraction: an equilibrium fluid of hard discs or spheres.

Points thrown at random grow into bodies that overlap; the overlaps are removed by minimising

    E = 1/2 sum_{i<j} (sigma_ij - r_ij)_+^2 + 1/2 sum_walls (a_i + g - y_i)_+^2,   sigma_ij = a_i + a_j + g

with g the smallest gap, r_ij the distance to the nearest image and y the distance to a wall. What comes out
has many pairs at just this gap; `fsi.arrangements.shaking` then shakes it into a fluid.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize

from fsi.arrangements.arrangement import Arrangement, SimulationCell, Wanted, volumes
from fsi.arrangements.shaking import shaken
from fsi.errors import InputError

Array = NDArray[np.float64]

# Fractions, of bodies grown by half the gap, up to which overlaps are removed in a moment: below random close
# packing (0.84 in the plane, 0.64 in space), where the minimum of E ceases to be zero.
LIMITS = {2: 0.78, 3: 0.55}
_TRIES = 5
_ITERATIONS = 5000
# Over the smallest radius: E is minimised for a gap larger by this, and so reached in finite time.
_MARGIN = 1e-4
_ROUNDING = 1e-12  # over the largest side: what wrapping and reading may cost a gap


def cell_for(radii: Array, fraction: float, periodic: tuple[bool, ...], aspect: float) -> SimulationCell:
    """The cell with this fraction of bodies; all sides but the last are `aspect` times the last."""
    d = len(periodic)
    volume = float(volumes(radii, d).sum()) / fraction
    last = (volume / aspect ** (d - 1)) ** (1.0 / d)
    return SimulationCell((aspect * last,) * (d - 1) + (last,), periodic)


def random_arrangement(radii: Array, w: Wanted) -> Arrangement:
    """Bodies of these radii at random, no two nearer than the gap, and none nearer to a wall.

    The same seed gives the same arrangement.

    Raises:
        InputError: the area fraction is above what this can do (named), or no arrangement was found.
    """
    largest = largest_fraction(radii, w.periodic, w.aspect, w.gap)
    if w.fraction > largest:
        raise InputError(
            f"area fraction = {w.fraction:g}: too large for {len(radii)} bodies at random with gaps of "
            f"{w.gap:g}; the largest possible is {np.floor(1e4 * largest) / 1e4:g}"
        )
    cell = cell_for(radii, w.fraction, w.periodic, w.aspect)
    gap = w.gap + _ROUNDING * max(cell.sides)
    rng = np.random.default_rng(w.seed)
    for _ in range(_TRIES):
        x = _without_overlaps(cell, radii, gap, rng.random((len(radii), cell.dimension)) * cell.sides)
        if x is not None:
            return Arrangement(cell, shaken(cell, x, radii, gap, rng), radii)
    raise InputError(
        f"area fraction = {w.fraction:g}: no arrangement of {len(radii)} bodies with gaps of {w.gap:g} "
        f"found in {_TRIES} tries; lower it or the gap, or place more bodies"
    )


def largest_fraction(radii: Array, periodic: tuple[bool, ...], aspect: float, gap: float) -> float:
    """The fraction at which bodies grown by half the gap, `gap`/2 off the walls, fill LIMITS of the room."""
    d = len(periodic)
    grown = float(volumes(radii + 0.5 * gap, d).sum())

    def excess(fraction: float) -> float:
        cell = cell_for(radii, fraction, periodic, aspect)
        room = np.array(cell.sides)
        room[cell.walled] -= gap
        fits = bool(np.all(np.array(cell.sides) > 2.0 * radii.max() + gap + gap * ~np.array(periodic)))
        return grown / float(np.prod(room)) - LIMITS[d] if fits else 1.0

    return float(brentq(excess, 1e-9, 1.0, xtol=1e-12))


def _without_overlaps(cell: SimulationCell, radii: Array, gap: float, x: Array) -> Array | None:
    """The points moved to the nearest minimum of E; None if overlaps remain there."""
    target = gap + _MARGIN * float(radii.min())

    def energy(flat: Array) -> tuple[float, Array]:
        return _energy(cell, radii, target, flat.reshape(x.shape))

    def stop_when_apart(flat: Array) -> None:
        if _smallest_excess(cell, radii, gap, flat.reshape(x.shape)) >= 0.0:
            raise StopIteration

    options = {"maxiter": _ITERATIONS, "maxfun": 2 * _ITERATIONS, "ftol": 0.0, "gtol": 0.0, "maxcor": 20}
    best = minimize(energy, x.ravel(), jac=True, method="L-BFGS-B", callback=stop_when_apart, options=options)
    moved = best.x.reshape(x.shape)
    return cell.wrapped(moved) if _smallest_excess(cell, radii, gap, moved) >= 0.0 else None


def _energy(cell: SimulationCell, radii: Array, gap: float, x: Array) -> tuple[float, Array]:
    """E and its gradient, flat."""
    pairs = cell.near_pairs(x, 2.0 * float(radii.max()) + gap)
    i, j = pairs[:, 0], pairs[:, 1]
    between = cell.separation(x[i], x[j])
    r = np.linalg.norm(between, axis=1)
    overlap = np.maximum(radii[i] + radii[j] + gap - r, 0.0)
    push = (overlap / np.maximum(r, 1e-300))[:, None] * between
    gradient = np.zeros_like(x)
    for axis in range(x.shape[1]):
        gradient[:, axis] = np.bincount(j, push[:, axis], len(x)) - np.bincount(i, push[:, axis], len(x))
    into_walls = np.maximum(radii[:, None] + gap - cell.wall_distances(x), 0.0)
    low, high = np.hsplit(into_walls, 2)
    gradient[:, cell.walled] += high - low
    return 0.5 * float(overlap @ overlap + np.sum(into_walls**2)), gradient.ravel()


def _smallest_excess(cell: SimulationCell, radii: Array, gap: float, x: Array) -> float:
    """The smallest gap, of pairs and walls, less the asked one."""
    pairs = cell.near_pairs(x, 2.0 * float(radii.max()) + gap)
    i, j = pairs[:, 0], pairs[:, 1]
    r = np.linalg.norm(cell.separation(x[i], x[j]), axis=1)
    to_walls = cell.wall_distances(x) - radii[:, None]
    return float(min((r - radii[i] - radii[j]).min(initial=np.inf), to_walls.min(initial=np.inf))) - gap
