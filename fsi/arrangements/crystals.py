"""Arrays of equal spheres: simple, body-centred and face-centred cubic, hexagonal close-packed.

Each is a right-angled unit cell, in units of the distance s of neighbours' centres, and the places of its m
spheres. With the volume v of a sphere and the sides l s of the unit cell, `m v = phi l_x l_y l_z s^3`. Walls,
where the cell has them, cut between layers: the outer ones are as far from either.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt

import numpy as np

from fsi.arrangements.arrangement import Arrangement, Wanted, too_large, volumes
from fsi.arrangements.cell import SimulationCell
from fsi.arrays import Array
from fsi.errors import InputError


@dataclass(frozen=True, slots=True)
class UnitCell:
    """What repeats.

    Attributes:
        sides: over the distance of neighbours' centres, (3,).
        places: of the centres in fractions of the sides, in [0, 1), (m, 3).
    """

    sides: tuple[float, float, float]
    places: tuple[tuple[float, float, float], ...]


CUBIC = UnitCell((1.0, 1.0, 1.0), ((0.0, 0.0, 0.0),))
BODY_CENTRED = UnitCell((2.0 / sqrt(3.0),) * 3, ((0.0, 0.0, 0.0), (0.5, 0.5, 0.5)))
FACE_CENTRED = UnitCell(
    (sqrt(2.0),) * 3, ((0.0, 0.0, 0.0), (0.0, 0.5, 0.5), (0.5, 0.0, 0.5), (0.5, 0.5, 0.0))
)
# Layers A B A B: in each, rows along x are half a distance apart; the next lies over its gaps.
CLOSE_PACKED = UnitCell(
    (1.0, sqrt(3.0), sqrt(8.0 / 3.0)),
    ((0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (0.0, 1.0 / 3.0, 0.5), (0.5, 5.0 / 6.0, 0.5)),
)


def crystal(unit: UnitCell) -> Callable[[Wanted], Arrangement]:
    """What makes an array of a unit cell. It raises InputError: the number or the fraction does not fit."""

    def arranged(w: Wanted) -> Arrangement:
        sides, places = np.array(unit.sides), np.array(unit.places)
        counts = _counts(w.number, len(places), sides)
        places = places + 0.5 * (1.0 - places.min(axis=0) - places.max(axis=0))
        of_one = float(volumes(w.radius, 3))
        s = (len(places) * of_one / (w.fraction * sides.prod())) ** (1.0 / 3.0)
        walled = ~np.array(w.periodic)
        least = max(
            w.apart, float(((w.radius + w.gap) / (sides * places.min(axis=0)))[walled].max(initial=0.0))
        )
        largest = len(places) * of_one / (sides.prod() * least**3)
        if w.fraction > largest * (1.0 + 1e-12):
            raise too_large(w.fraction, f"gaps of {w.gap:g} radii", largest)
        every = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 1, 3)
        centres: Array = ((every + places) * sides * s).reshape(-1, 3)
        cell = SimulationCell(tuple((counts * sides * s).tolist()), w.periodic)
        return Arrangement(cell, cell.wrapped(centres), np.full(w.number, w.radius))

    return arranged


def _counts(number: int, each: int, sides: Array) -> Array:
    """How many unit cells along each axis, so that all is as near to a cube as can be, (3,)."""
    cells, rest = divmod(number, each)
    if rest:
        remedy = f"give {each * max(cells, 1)}"
        raise InputError(f"number = {number}: no multiple of {each}, the spheres of a unit cell; {remedy}")
    divisors = [k for k in range(1, cells + 1) if cells % k == 0]
    ways = [(k, m, cells // (k * m)) for k in divisors for m in divisors if cells % (k * m) == 0]
    return np.array(min(ways, key=lambda way: float(np.ptp(np.log(np.array(way) * sides)))))
