"""Neighbours: pairs of bodies, bodies and walls, bodies and periodic images, with gaps and directions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fsi.bodies import Array, Configuration
from fsi.cell import ghosts, reduced_basis, wrapping
from fsi.reduced.space import Space, wall_gaps


@dataclass(frozen=True, slots=True)
class Pairs:
    """P pairs in d dimensions, ordered by key; side i is a body, side j a body or, from N on, wall j - N.

    i, j, is_wall: (P,); shift: what the image of body j is moved by, (P, d); n: unit normals from j to i, so
    that `D' = n.(u_i - u_j) - b`, (P, d); gap: D(q), (P,); radius: the reduced radius a_r, (P,);
    curvature: of D across n, `G'.u = curvature |u_i - u_j across n|^2`, (P,); b: how fast side j
    moves along n by itself, as a wall or with the lattice, (P,); key: of the pair as long as the bodies are
    the same, rows (i, j, periods), (P, 2 + k).
    """

    i: NDArray[np.intp]
    j: NDArray[np.intp]
    is_wall: NDArray[np.bool_]
    shift: Array
    n: Array
    gap: Array
    radius: Array
    curvature: Array
    b: Array
    key: NDArray[np.int64]

    def __len__(self) -> int:
        """Number of pairs P."""
        return len(self.gap)


def find_pairs(q: Configuration, space: Space, reach: float, kept: NDArray[np.int64] | None = None) -> Pairs:
    """All pairs with a gap up to `reach`, perhaps infinite, and those with the keys `kept` (K, 2 + k)."""
    sides, shift = _near_bodies(q, space, reach)
    walls = wall_gaps(space.container, q.centres, q.radii)
    body, wall = np.nonzero((walls.gap <= reach) & walls.lubricates)
    k = len(space.periods)
    periods = np.rint(shift @ np.linalg.pinv(space.periods)) if k else np.empty((len(shift), 0))
    key = np.vstack(
        [
            np.column_stack([sides, periods]),
            np.column_stack([body, len(q) + wall, np.zeros((len(body), k))]),
        ]
    ).astype(np.int64)
    if kept is not None and len(kept):
        key = np.vstack([key, kept])
    return of_keys(q, space, _distinct(key))


def _distinct(key: NDArray[np.int64]) -> NDArray[np.int64]:
    """The rows in order, each once."""
    key = key[np.lexsort(key.T[::-1])]
    new = np.ones(len(key), dtype=bool)
    new[1:] = np.any(key[1:] != key[:-1], axis=1)
    return key[new]


def of_keys(q: Configuration, space: Space, key: NDArray[np.int64]) -> Pairs:
    """The pairs with these keys (P, 2 + k), as they are now."""
    i, j = key[:, 0].astype(np.intp), key[:, 1].astype(np.intp)
    shift = key[:, 2:] @ space.periods
    is_wall = j >= len(q)
    other = np.where(is_wall, 0, j)
    separation = q.centres[i] - q.centres[other] - shift
    distance = np.sqrt(np.einsum("pk,pk->p", separation, separation))
    n = separation / np.where(distance > 0.0, distance, 1.0)[:, None]
    gap = distance - q.radii[i] - q.radii[other]
    radius = q.radii[i] * q.radii[other] / (q.radii[i] + q.radii[other])
    curvature = 1.0 / np.where(distance > 0.0, distance, 1.0)
    if np.any(is_wall):
        walls, at = wall_gaps(space.container, q.centres, q.radii), (i[is_wall], j[is_wall] - len(q))
        n[is_wall], gap[is_wall] = walls.normal[at], walls.gap[at]
        curvature[is_wall] = walls.curvature[at]
        radius[is_wall] = walls.radius[at]
    b = own_speed(n, shift, np.where(is_wall, j - len(q), -1), space)
    return Pairs(i, j, is_wall, shift, n, gap, radius, curvature, b, key)


def own_speed(n: Array, shift: Array, wall: NDArray[np.intp], space: Space) -> Array:
    """b, how fast sides j move along n as walls (P,), -1 for none, or with the lattice; shape (P,)."""
    velocity = shift @ space.gradient.T
    velocity[wall >= 0] = space.wall_velocity[wall[wall >= 0]]
    b: Array = np.einsum("pk,pk->p", n, velocity)
    return b


def _near_bodies(q: Configuration, space: Space, reach: float) -> tuple[NDArray[np.intp], Array]:
    """Sides (P, 2) and shifts (P, d) of all pairs of bodies and images with a gap of at most `reach`."""
    N, d = q.centres.shape
    if not np.isfinite(reach):
        i, j = np.triu_indices(N, 1)
        return np.column_stack([i, j]), np.zeros((len(i), d))
    furthest = 2.0 * float(q.radii.max(initial=0.0)) + reach
    vectors = reduced_basis(space.periods)
    wrap = wrapping(q.centres, vectors) if len(vectors) else np.zeros((N, d))
    x = q.centres + wrap
    tree = cKDTree(x)
    sides = tree.query_pairs(furthest, output_type="ndarray").astype(np.intp).reshape(-1, 2)
    images = np.zeros((len(sides), d))
    if len(vectors):
        original, moved = ghosts(x, vectors, furthest)
        found = tree.sparse_distance_matrix(cKDTree(x[original] + moved), furthest, output_type="ndarray")
        sides = np.vstack([sides, np.column_stack([found["i"], original[found["j"]]])])
        images = np.vstack([images, moved[found["j"]]])
    i, j = sides.T
    shift = images + wrap[j] - wrap[i]
    turn = i > j
    sides, shift = np.sort(sides, axis=1), np.where(turn[:, None], -shift, shift)
    i, j = sides.T
    apart = q.centres[i] - q.centres[j] - shift
    close = np.sqrt(np.einsum("pk,pk->p", apart, apart)) - q.radii[i] - q.radii[j] <= reach
    return sides[close], shift[close]


def turning(pairs: Pairs, u: Array) -> Array:
    """`G'.u`, how D' changes because the directions turn, for velocities (N, d); shape (P,)."""
    other = np.where(pairs.is_wall[:, None], 0.0, u[np.where(pairs.is_wall, 0, pairs.j)])
    relative = u[pairs.i] - other
    along = np.einsum("pk,pk->p", pairs.n, relative)
    across: Array = np.einsum("pk,pk->p", relative, relative) - along**2
    return pairs.curvature * across
