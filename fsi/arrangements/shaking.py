"""Metropolis moves of hard bodies: the way from any arrangement without overlaps to the equilibrium fluid.

Every arrangement without overlaps is equally probable there (N. Metropolis et al., J. Chem. Phys. 21 (1953)
1087). Many bodies move at once (J. A. Anderson et al., J. Comput. Phys. 254 (2013) 27): of a chequerboard,
laid anew for each move, the squares of one colour each choose one body, which may not leave it; they are so
wide that two such bodies never meet. As no choice depends on the outcome of a move, every move is as likely
as its reverse.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.arrangements.arrangement import SimulationCell

Array = NDArray[np.float64]

_MOVES = 1000  # of about a fifth of the bodies in the plane, a tenth in space
_LENGTH, _MARGIN = 0.2, 0.8  # of a move, and of the list of neighbours, over the mean radius


@dataclass(frozen=True, slots=True)
class _Neighbours:
    """Pairs that may meet while no body is further than half the margin from where it was.

    Attributes:
        start: where the bodies were, shape (N, d).
        i, j: the pairs, (P,).
        contact: the least distance of their centres, (P,).
    """

    start: Array
    i: NDArray[np.intp]
    j: NDArray[np.intp]
    contact: Array


def shaken(cell: SimulationCell, x: Array, radii: Array, gap: float, rng: np.random.Generator) -> Array:
    """The bodies at x (N, d) after some 200 moves each (100 in space), gaps at least `gap`."""
    margin, length = _MARGIN * float(radii.mean()), _LENGTH * float(radii.mean())
    diameter = 2.0 * float(radii.max()) + gap
    near = _neighbours(cell, x, radii, gap, diameter + margin)
    for _ in range(_MOVES):
        if np.linalg.norm(x - near.start, axis=1).max() > 0.5 * margin - 2.0 * length:
            near = _neighbours(cell, x, radii, gap, diameter + margin)
        moved, good = _proposal(cell, x, diameter + 2.0 * length, length, rng)
        touching = np.linalg.norm(cell.separation(moved[near.i], moved[near.j]), axis=1) < near.contact
        good[near.i[touching]] = good[near.j[touching]] = False
        good &= np.all(cell.wall_distances(moved) >= radii[:, None] + gap, axis=1)
        x = np.where(good[:, None], moved, x)
    return cell.wrapped(x)


def _neighbours(cell: SimulationCell, x: Array, radii: Array, gap: float, reach: float) -> _Neighbours:
    i, j = cell.near_pairs(x, reach).T
    return _Neighbours(x, i, j, radii[i] + radii[j] + gap)


def _proposal(
    cell: SimulationCell, x: Array, width: float, length: float, rng: np.random.Generator
) -> tuple[Array, NDArray[np.bool_]]:
    """Where the bodies try to go, and which of them try."""
    sides = np.array(cell.sides)
    squares = np.maximum(2 * (sides // (2.0 * width)), 1)  # even: colours alternate across periodic sides
    shift, colour = rng.random(cell.dimension) * sides, rng.integers(2, size=cell.dimension)
    shift[(squares == 1) & ~np.array(cell.periodic)] = 0.0  # or there would be two, of one colour

    def square(y: Array) -> Array:
        index: Array = np.floor((y + shift) / sides * squares)
        return index

    home = square(x)
    number = np.where(cell.periodic, home % squares, home).astype(np.intp)
    counts = number.max(axis=0) + 1
    flat = np.ravel_multi_index(tuple(number.T), tuple(counts))
    order = rng.permutation(len(x))
    occupant = np.full(int(np.prod(counts)), -1)
    occupant[flat[order]] = order  # the last one stays
    chosen = occupant[flat] == np.arange(len(x))
    chosen &= np.all((number % 2 == colour) | (squares == 1), axis=1)
    moved = x + np.where(chosen[:, None], rng.uniform(-length, length, x.shape), 0.0)
    return moved, chosen & np.all(square(moved) == home, axis=1)
