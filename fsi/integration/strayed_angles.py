"""How distances in angle go along with bodies that turn in space, and how far off rotation vectors then are.

Where a body is turned by e beyond a run, exp(e) R in place of R, and both go on to turn with omega, e turns
as well: e' = omega x e. Distances are of the exact places from those of a run, by cause, elements and steps.
"""

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.meshes.geometry.rotations import turn_between, turned


def places_of(q: Configuration) -> Array:
    """Centres and angles, (N, M)."""
    return np.column_stack([q.centres, q.angles])


def turn_since(places: Array, q: Configuration) -> Array:
    """By what the bodies have turned since they were at these places (N, M), (N, r)."""
    return turn_between(places[:, q.dimension :].reshape(q.angles.shape), q.angles).reshape(len(q), -1)


def turned_along(distances: Array, turn: Array) -> Array:
    """Distances by cause, (2, N, M), with those in angle turned in space, by (N, 3), as the bodies are."""
    if turn.shape[1] != 3:
        return distances
    angles = distances[..., 3:].swapaxes(0, 1)
    more = turned(angles, np.repeat(turn[:, None], 2, axis=1))
    return np.concatenate([distances[..., :3], (angles + more).swapaxes(0, 1)], axis=-1)


def in_columns(q: Configuration, e: Array) -> Array:
    """By cause, how far positions and angles are off in bodies.csv at distances e, (2, N, M) each.

    In space angles are rotation vectors, and what steps miss turns on the way: only its size is known.
    """
    off = np.stack([q.rates(places_of(q), distance) for distance in e])
    if q.dimension == 3:
        off[1, :, 3:] = np.linalg.norm(off[1, :, 3:], axis=1, keepdims=True)
    return off
