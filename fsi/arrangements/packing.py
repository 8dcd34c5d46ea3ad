"""Random arrangements at a given area fraction: an equilibrium fluid of hard discs or spheres.

Points thrown at random grow into bodies that overlap; the overlaps are removed by minimising

    E = 1/2 sum_{i<j} (sigma_ij - r_ij)_+^2 + 1/2 sum_walls (a_i + g - y_i)_+^2,   sigma_ij = a_i + a_j + g

with g the smallest gap, r_ij the distance to the nearest image and y the distance to a wall. What comes out
has many pairs at just this gap; Metropolis moves then shake it into a fluid.

Every arrangement without overlaps is equally probable there (N. Metropolis et al., J. Chem. Phys. 21 (1953)
1087). Many bodies move at once (J. A. Anderson et al., J. Comput. Phys. 254 (2013) 27): of a chequerboard,
laid anew for each move, the squares of one colour each choose one body, which may not leave it; they are so
wide that two such bodies never meet. As no choice depends on the outcome of a move, every move is as likely
as its reverse.
"""

from dataclasses import dataclass

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import NDArray

from fsi.arrangements.arrangement import Arrangement, Wanted, too_large, volumes
from fsi.arrangements.cell import SimulationCell
from fsi.arrays import Array
from fsi.errors import InputError

# Fractions, of bodies grown by half the gap, up to which overlaps are removed in a moment: below random close
# packing (0.84 in the plane, 0.64 in space), where the minimum of E ceases to be zero.
LIMITS = {2: 0.78, 3: 0.55}
TRIES = 5
ITERATIONS = 5000
# Over the smallest radius: E is minimised for a gap larger by this, and so reached in finite time.
MARGIN = 1e-4
ROUNDING = 1e-12  # over the largest side: what wrapping and reading may cost a gap


def cell_for(radii: Array, fraction: float, periodic: tuple[bool, ...], aspect: float) -> SimulationCell:
    """The cell with this fraction of bodies; all sides but the last are `aspect` times the last."""
    d = len(periodic)
    volume = float(volumes(radii, d).sum()) / fraction
    last = (volume / aspect ** (d - 1)) ** (1.0 / d)
    return SimulationCell((aspect * last,) * (d - 1) + (last,), periodic)


def random_arrangement(radii: Array, w: Wanted) -> Arrangement:
    """Bodies of these radii at random, no two nearer than the gap, and none nearer to a wall.

    The same seed gives the same arrangement. Raises InputError: the area fraction is above what this can do
    (named), or no arrangement was found.
    """
    largest = largest_fraction(radii, w.periodic, w.aspect, w.gap)
    if w.fraction > largest:
        here = f"{len(radii)} bodies at random with gaps of {w.gap:g} radii"
        raise too_large(w.fraction, here, largest)
    cell = cell_for(radii, w.fraction, w.periodic, w.aspect)
    gap = w.gap + ROUNDING * max(cell.sides)
    rng = np.random.default_rng(w.seed)
    for _ in range(TRIES):
        x = _without_overlaps(cell, radii, gap, rng.random((len(radii), cell.dimension)) * cell.sides)
        if x is not None:
            return Arrangement(cell, shaken(cell, x, radii, gap, rng), radii)
    raise InputError(
        f"area_fraction = {w.fraction:g}: no arrangement of {len(radii)} bodies with gaps of {w.gap:g} radii "
        f"found in {TRIES} tries; lower it or the gap, or place more bodies"
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

    low = high = 1.0
    while excess(low) > 0.0:
        low, high = 0.1 * low, low
    return float(scipy.optimize.brentq(excess, low, high, xtol=1e-12 * low))


def _without_overlaps(cell: SimulationCell, radii: Array, gap: float, x: Array) -> Array | None:
    """The points moved to the nearest minimum of E; None if overlaps remain there."""
    target = gap + MARGIN * float(radii.min())

    def energy(flat: Array) -> tuple[float, Array]:
        return _energy(cell, radii, target, flat.reshape(x.shape))

    def stop_when_apart(flat: Array) -> None:
        if _smallest_excess(cell, radii, gap, flat.reshape(x.shape)) >= 0.0:
            raise StopIteration

    options = {"maxiter": ITERATIONS, "maxfun": 2 * ITERATIONS, "ftol": 0.0, "gtol": 0.0, "maxcor": 20}
    best = scipy.optimize.minimize(
        energy, x.ravel(), jac=True, method="L-BFGS-B", callback=stop_when_apart, options=options
    )
    moved = best.x.reshape(x.shape)
    return cell.wrapped(moved) if _smallest_excess(cell, radii, gap, moved) >= 0.0 else None


def _energy(cell: SimulationCell, radii: Array, gap: float, x: Array) -> tuple[float, Array]:
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
    pairs = cell.near_pairs(x, 2.0 * float(radii.max()) + gap)
    i, j = pairs[:, 0], pairs[:, 1]
    r = np.linalg.norm(cell.separation(x[i], x[j]), axis=1)
    to_walls = cell.wall_distances(x) - radii[:, None]
    return float(min((r - radii[i] - radii[j]).min(initial=np.inf), to_walls.min(initial=np.inf))) - gap


# In the plane, moves of about a fifth of the bodies each. In space, where a move is of a tenth or less, tries
# of each body: by then pairs near contact are as many as in equilibrium within 1 %, up to a fraction of 0.45.
MOVES, TRIES_IN_SPACE = 1000, 600
# Over the mean radius: of a move; how far beyond contact neighbours are listed, for some ten moves to come.
LENGTH, _NEIGHBOURHOOD = 0.2, 2.0


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
    """The bodies at x (N, d) after some 200 tries each (600 in space), gaps at least `gap`."""
    margin, length = _NEIGHBOURHOOD * float(radii.mean()), LENGTH * float(radii.mean())
    diameter, plane = 2.0 * float(radii.max()) + gap, cell.dimension == 2
    # Squares as wide as bodies are enough; by wider ones in the plane seeded arrangements keep their places.
    width = diameter + 2.0 * length if plane else diameter
    near = _neighbours(cell, x, radii, gap, diameter + margin)
    moves = tries = 0
    while moves < MOVES if plane else tries < TRIES_IN_SPACE * len(x):
        if np.linalg.norm(x - near.start, axis=1).max() > 0.5 * margin - 2.0 * length:
            near = _neighbours(cell, x, radii, gap, diameter + margin)
        moved, good = proposal(cell, x, width, length, rng)
        moves, tries = moves + 1, tries + int(np.count_nonzero(good))
        tried = np.flatnonzero(good[near.i] | good[near.j])
        i, j = near.i[tried], near.j[tried]
        touching = np.linalg.norm(cell.separation(moved[i], moved[j]), axis=1) < near.contact[tried]
        good[i[touching]] = good[j[touching]] = False
        good &= np.all(cell.wall_distances(moved) >= radii[:, None] + gap, axis=1)
        x = np.where(good[:, None], moved, x)
    return cell.wrapped(x)


def _neighbours(cell: SimulationCell, x: Array, radii: Array, gap: float, reach: float) -> _Neighbours:
    i, j = cell.near_pairs(x, reach).T
    return _Neighbours(x, i, j, radii[i] + radii[j] + gap)


def proposal(
    cell: SimulationCell, x: Array, width: float, length: float, rng: np.random.Generator
) -> tuple[Array, NDArray[np.bool_]]:
    """Where the bodies try to go, and which of them try."""
    sides = np.array(cell.sides)
    squares = np.maximum(2 * (sides // (2.0 * width)), 1)  # even: colours alternate across periodic sides
    shift, colour = rng.random(cell.dimension) * sides, rng.integers(2, size=cell.dimension)
    shift[(squares == 1) & ~np.array(cell.periodic)] = 0.0  # or there would be two, of one colour

    def square(y: Array) -> Array:
        return np.asarray(np.floor((y + shift) / sides * squares))

    home = square(x)
    number = np.where(cell.periodic, home % squares, home).astype(np.intp)
    chosen = _one_of_each(number, rng)
    chosen &= np.all((number % 2 == colour) | (squares == 1), axis=1)
    moved = x + np.where(chosen[:, None], rng.uniform(-length, length, x.shape), 0.0)
    return moved, chosen & np.all(square(moved) == home, axis=1)


def _one_of_each(number: NDArray[np.intp], rng: np.random.Generator) -> NDArray[np.bool_]:
    """One body of each square, all of its bodies as likely, (N,); `number` of the square of each, (N, d).

    Squares without bodies take neither time nor memory: of a dilute arrangement they are nearly all.
    """
    order = rng.permutation(len(number))
    order = order[np.lexsort(number[order].T)]  # which leaves those of one square in their order
    is_last = np.any(np.diff(number[order], axis=0, append=-1) != 0, axis=1)
    chosen = np.zeros(len(number), dtype=np.bool_)
    chosen[order[is_last]] = True
    return chosen
