"""Pairs of neighbours, and the rows `G`, `T` that turn velocities into rates of gaps and of slip.

Centres have shape (N, d) with d = 1, 2, 3. Velocities U have shape (N, d + r): those of the centres, then the
angular ones, r = 0, 1, 3 in these dimensions. Side i of a contact is a body or, from N on, a wall; side j
is a body; the normal points from i to j, so that `G.U = n.(v_j - v_i)` is the rate of the gap D.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.neighbours import neighbours
from fsi.lubrication.sliding import arms, tangents
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import Lattice


@dataclass(frozen=True, slots=True)
class Room:
    """What bounds the bodies.

    Attributes:
        points: a point of each plane wall, shape (W, d).
        normals: its unit normal into the room, shape (W, d).
        container: whose periods carry bodies onto their images.
    """

    points: Array
    normals: Array
    container: Container


@dataclass(frozen=True, slots=True)
class Contacts:
    """Close pairs, ordered by key.

    i, j: the two sides, shape (C,); n: unit normals from i to j, (C, d); D: gaps, (C,);
    key: one integer for each pair, the same as long as the bodies are.
    """

    i: NDArray[np.intp]
    j: NDArray[np.intp]
    n: Array
    D: Array
    key: NDArray[np.int64]

    def __len__(self) -> int:
        """Number of contacts C."""
        return len(self.D)

    def __getitem__(self, chosen: NDArray[np.intp]) -> Contacts:
        """Some of them, or some repeated."""
        return Contacts(self.i[chosen], self.j[chosen], self.n[chosen], self.D[chosen], self.key[chosen])


def find_contacts(centres: Array, radii: Array, room: Room, reach: float) -> Contacts:
    """All pairs of bodies, and of bodies and walls, whose gap is at most `reach`."""
    N, W = len(centres), len(room.points)
    # No nearest image is farther than a periodic room is large, however far a step looks.
    farthest = min(reach, room.container.size()) if len(room.container.periods) else reach
    pairs, shift = neighbours(centres, room.container, 2.0 * float(radii.max(initial=0.0)) + farthest)
    i, j = pairs[:, 0], pairs[:, 1]
    separation = centres.take(j, axis=0) - centres.take(i, axis=0)
    if len(room.container.periods):
        separation += Lattice(room.container.periods).shift(shift)
    distance = np.linalg.norm(separation, axis=1)
    above = np.einsum("bwd,wd->bw", centres[:, None, :] - room.points, room.normals) - radii[:, None]
    body, wall = np.nonzero(above <= reach)
    i = np.concatenate([i, N + wall])
    j = np.concatenate([j, body])
    D = np.concatenate([distance - radii[i[: len(distance)]] - radii[j[: len(distance)]], above[body, wall]])
    with np.errstate(invalid="ignore"):
        n = np.concatenate([separation / distance[:, None], room.normals[wall]])
    key = i.astype(np.int64) * (N + W) + j
    near_enough = np.flatnonzero(reach >= D)
    order = near_enough[np.argsort(key[near_enough])]
    if len(room.container.periods):
        # Of several images of a pair the nearest one counts, and a body does not meet its own.
        order = near_enough[np.lexsort((D[near_enough], key[near_enough]))]
        order = order[np.unique(key[order], return_index=True)[1]]
        order = order[i[order] != j[order]]
    return Contacts(i[order], j[order], n[order], D[order], key[order])


def smallest_gap(centres: Array, radii: Array, room: Room) -> float:
    """The smallest of all gaps, however wide; infinite for a lone body without walls."""
    reach = 2.0 * float(radii.max(initial=0.0))
    to_walls = np.linalg.norm(centres[:, None] - room.points, axis=2).max(initial=0.0)
    across = room.container.size() if len(room.container.periods) else np.linalg.norm(np.ptp(centres, axis=0))
    farthest = max(float(to_walls), float(across))
    gaps = find_contacts(centres, radii, room, reach).D
    while len(gaps) == 0 and reach < farthest:
        reach *= 2.0
        gaps = find_contacts(centres, radii, room, reach).D
    return float(gaps.min(initial=np.inf))


def gap_rows(contacts: Contacts, N: int, modes: int) -> sp.csr_matrix:
    """G, one row a contact, (C, N modes): `G U` are the rates of the gaps."""
    return _rows(contacts, N, modes, contacts.n, -contacts.n)


def slip_rows(contacts: Contacts, radii: Array, modes: int) -> sp.csr_matrix:
    """T, d - 1 rows a contact (C (d - 1), N modes): the velocity of j's surface past i's, at the contact.

    A surface point of j moves at `v_j - l_j omega_j x n`, one of i at `v_i + l_i omega_i x n`. Bodies D apart
    have `arms`, which meet between them, so that friction keeps their angular momentum; walls take it up.
    """
    n, d = contacts.n, contacts.n.shape[1]
    pair, a_j = (contacts.i < len(radii))[:, None], radii[contacts.j][:, None]
    a_i = np.append(radii, 0.0)[np.minimum(contacts.i, len(radii))][:, None]
    l_i, l_j = arms(a_i, a_j, np.where(pair, contacts.D[:, None], 0.0))
    if d == 2:
        (t,), one = tangents(n), np.ones((len(n), 1))
        return _rows(contacts, len(radii), modes, np.hstack([t, -l_j * one]), np.hstack([-t, -l_i * one]))
    t1, t2 = tangents(n)
    both = [  # t.(omega x n) = omega.(n x t), with n x t1 = t2 and n x t2 = -t1
        (np.hstack([t1, -l_j * t2]), np.hstack([-t1, -l_i * t2])),
        (np.hstack([t2, l_j * t1]), np.hstack([-t2, l_i * t1])),
    ]
    of_j, of_i = (np.stack([rows[side] for rows in both], axis=1).reshape(-1, 6) for side in (0, 1))
    return _rows(contacts[np.repeat(np.arange(len(n)), 2)], len(radii), modes, of_j, of_i)


def _rows(contacts: Contacts, N: int, modes: int, of_j: Array, of_i: Array) -> sp.csr_matrix:
    """The sparse matrix with the entries `of_j`, `of_i`, shape (C, k <= modes), at the modes of j and i."""
    C, k = of_j.shape
    pair = np.flatnonzero(contacts.i < N)
    row = np.concatenate([np.repeat(np.arange(C), k), np.repeat(pair, k)])
    column = np.concatenate(
        [
            (contacts.j[:, None] * modes + np.arange(k)).ravel(),
            (contacts.i[pair, None] * modes + np.arange(k)).ravel(),
        ]
    )
    return sp.csr_matrix((np.concatenate([of_j.ravel(), of_i[pair].ravel()]), (row, column)), (C, N * modes))
