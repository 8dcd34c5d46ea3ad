"""Neighbours: pairs of bodies, bodies and walls, bodies and periodic images, with gaps and directions."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps, row_numbers
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.geometry.reentrant import counted
from fsi.reduced.enclosure import Enclosure, WallGaps, overlap, wall_gaps
from fsi.reduced.gap_laws import Films
from fsi.reduced.twice_precise import precise_gaps

# Gaps below this times the reduced radius lose more than 1e-11 of themselves in the distance of the centres.
_NARROW = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """P pairs in d dimensions, ordered by key.

    Attributes:
        i: a body, (P,).
        j: a body or, from N on, wall j - N, (P,).
        is_wall: which, (P,).
        shift: what the image of body j is moved by, (P, d).
        foot: the points of walls next to bodies, of the W pairs with one, (W, d).
        n: unit normals from j to i, so that `D' = n.(u_i - u_j) - b`, (P, d).
        gap: D(q), (P,).
        radius: the reduced radius a_r = a b/(a + b), (P,).
        overlap: a b/(a + b)^2, from 1/4 of equal bodies to 0 beside a plane, less in a round wall, (P,).
        curvature: of D across n, `G'.u = curvature |u_i - u_j across n|^2`, (P,).
        b: how fast side j moves along n by itself, as a wall or with the lattice, (P,).
        key: of the pair as long as the bodies are the same, rows (i, j, periods), (P, 2 + k).
    """

    i: NDArray[np.intp]
    j: NDArray[np.intp]
    is_wall: NDArray[np.bool_]
    shift: Array
    foot: Array
    n: Array
    gap: Array
    radius: Array
    overlap: Array
    curvature: Array
    b: Array
    key: NDArray[np.int64]

    def __len__(self) -> int:
        """Number of pairs P."""
        return len(self.gap)

    @property
    def across_period(self) -> NDArray[np.bool_]:
        """Which pairs are of a body and a periodic image, (P,)."""
        moved: NDArray[np.bool_] = np.zeros(len(self), dtype=bool)
        for component in self.shift.T:
            moved |= component != 0.0
        return moved

    @property
    def films(self) -> Films:
        """What laws are told."""
        return Films(self.radius, self.overlap, self.is_wall)


def find_pairs(
    q: Configuration, enclosure: Enclosure, reach: float, also: NDArray[np.int64] | None = None
) -> Pairs:
    """All pairs with a gap up to `reach`, perhaps infinite, and those with the keys `also` (K, 2 + k)."""
    gaps, lattice = find_gaps(q, enclosure.container, reach), Lattice(enclosure.container.periods)
    walls = wall_gaps(enclosure.container, q.centres, q.radii)
    near = (walls.gap <= reach) & walls.lubricates & enclosure.solid
    body, wall = np.nonzero(counted(enclosure.container, q.centres, near))
    periods = np.rint(lattice.coordinates(gaps.away))
    key = np.vstack(
        [
            np.column_stack([gaps.pairs, periods]),
            np.column_stack([body, len(q) + wall, np.zeros((len(body), lattice.dimension))]),
        ]
    ).astype(np.int64)
    if also is not None and len(also):
        key = np.vstack([key, also])
    return of_keys(q, enclosure, _distinct(key))


def _distinct(key: NDArray[np.int64]) -> NDArray[np.int64]:
    """The rows in order, each once."""
    (number,) = row_numbers(key)
    order = np.argsort(number, kind="stable")  # quick where parts are in order already
    new = np.diff(number[order], prepend=-1) > 0
    return key[order[new]]


def of_keys(q: Configuration, enclosure: Enclosure, key: NDArray[np.int64]) -> Pairs:
    """The pairs with these keys (P, 2 + k), as they are now."""
    i, j = key[:, 0].astype(np.intp), key[:, 1].astype(np.intp)
    shift = Lattice(enclosure.container.periods).shift(key[:, 2:]) + np.zeros((1, q.dimension))
    is_wall = j >= len(q)
    other = np.where(is_wall, 0, j)
    radius = q.radii[i] * q.radii[other] / (q.radii[i] + q.radii[other])
    separation, distance, gap = _apart(q, (i, other), shift, radius)
    n = separation / np.where(distance > 0.0, distance, 1.0)[:, None]
    curvature = 1.0 / np.where(distance > 0.0, distance, 1.0)
    if np.any(is_wall):
        walls, at = _beside(q, enclosure, i[is_wall], j[is_wall])
        n[is_wall], gap[is_wall] = walls.normal[at], walls.gap[at]
        curvature[is_wall] = walls.curvature[at]
        radius[is_wall] = walls.radius[at]
    foot = q.centres[i[is_wall]] - (gap + q.radii[i])[is_wall, None] * n[is_wall]
    share, rest = overlap(radius, q.radii[i]), np.zeros(len(gap))
    pairs = Pairs(i, j, is_wall, shift, foot, n, gap, radius, share, curvature, rest, key)
    return replace(pairs, b=own_speed(pairs, len(q), enclosure))


def gaps_at(q: Configuration, enclosure: Enclosure, pairs: Pairs) -> Array:
    """D of the same pairs where the bodies are at q, (P,)."""
    sides = pairs.i, np.where(pairs.is_wall, 0, pairs.j)
    _, _, gap = _apart(q, sides, pairs.shift, pairs.radius)
    if np.any(pairs.is_wall):
        walls, at = _beside(q, enclosure, pairs.i[pairs.is_wall], pairs.j[pairs.is_wall])
        gap[pairs.is_wall] = walls.gap[at]
    return gap


def _apart(
    q: Configuration, sides: tuple[Indices, Indices], shift: Array, radius: Array
) -> tuple[Array, ...]:
    """Of centres i from the images of centres j: separation (P, d), distance and gap, (P,)."""
    i, j = sides
    separation = q.centres.take(i, axis=0) - q.centres.take(j, axis=0) - shift
    distance = np.sqrt(np.einsum("pk,pk->p", separation, separation))
    gap = distance - q.radii[i] - q.radii[j]
    narrow = np.flatnonzero(np.abs(gap) < _NARROW * radius)
    if len(narrow):
        k, other = i[narrow], j[narrow]
        ends = (q.centres[k], q.centres[other], shift[narrow])
        gap[narrow] = precise_gaps(*ends, q.radii[k], q.radii[other])
    return separation, distance, gap


def _beside(
    q: Configuration, enclosure: Enclosure, body: Indices, wall: Indices
) -> tuple[WallGaps, tuple[Indices, Indices]]:
    """All walls beside so many bodies, and which of those gaps are meant; wall: counted from N on."""
    walls = wall_gaps(enclosure.container, q.centres.take(body, axis=0), q.radii[body])
    return walls, (np.arange(len(body)), wall - len(q))


def own_speed(pairs: Pairs, bodies: int, enclosure: Enclosure) -> Array:
    """b, how fast sides j move along n by themselves, (P,)."""
    b: Array = np.einsum("pk,pk->p", pairs.n, own_velocity(pairs, bodies, enclosure))
    return b


def own_velocity(pairs: Pairs, bodies: int, enclosure: Enclosure) -> Array:
    """How sides j of so many bodies move by themselves: with the lattice, or as their walls, (P, d)."""
    velocity = pairs.shift @ enclosure.gradient.T
    walls = pairs.j[pairs.is_wall] - bodies
    velocity[pairs.is_wall] = enclosure.wall_velocities.at(walls, pairs.foot)
    return velocity


def turning(pairs: Pairs, u: Array) -> Array:
    """`G'.u`, how D' changes because the directions turn, for velocities (N, d); shape (P,)."""
    other = u.take(np.where(pairs.is_wall, 0, pairs.j), axis=0)
    other[pairs.is_wall] = 0.0
    relative = u.take(pairs.i, axis=0) - other
    along = np.einsum("pk,pk->p", pairs.n, relative)
    across: Array = np.einsum("pk,pk->p", relative, relative) - along**2
    return pairs.curvature * across
