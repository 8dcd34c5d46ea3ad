"""Bodies that one step carries past each other: what its linear gaps bear no longer.

A step sees of a body that another one meets the tangent plane where the line of centres crosses it. Along
the plane, by a way w, the true gap of what touches it grows by about `w^2 / (2 (a_i + a_j))`: over several
radii bodies are pushed that never meet. A plane wall is its own tangent. In a periodic room it sees the
nearest image of a body alone: over half a period bodies pass through others.
"""

import numpy as np

from fsi.arrays import Array
from fsi.errors import SolveError
from fsi.gluey.contacts import Contacts, gap_rows
from fsi.gluey.system import System
from fsi.meshes.geometry.lattice import Lattice

# Of the smaller radius of a pair: how far apart it may push.
APART = 0.1
# Of the smallest radius: linear gaps that are closed, 1e4 times wider than the projection leaves them.
CLOSED = 1e-6
# Of a period: how far bodies may go past each other. They cannot meet another image and part from it again.
SEEN = 0.5


def require_seen(system: System, U: Array, h: float, t: float) -> None:
    """Refuse a step h to t that may carry bodies through images that it does not see. Raises SolveError."""
    periods = system.room.container.periods
    if not len(periods) or len(U) < 2:
        return
    ways = Lattice(periods).coordinates(h * U[:, : system.dimension])
    farthest = float(np.ptp(ways, axis=0).max())
    if farthest > SEEN:
        raise SolveError(
            f"bodies go {farthest:.3g} periods past each other in the step to t = {t:.9g}, through images "
            "that it does not see; lower time.step"
        )


def require_met(system: System, contacts: Contacts, p: Array, U: Array, h: float, t: float) -> None:
    """Refuse a step h to t that pushes bodies which come near each other at no time in it.

    p: impulses of the contacts, (C,); U: velocities of the step, (N, modes). Raises SolveError.
    """
    N, radii, delta0 = len(U), system.radii, system.law.delta0
    left = contacts.D + h * (gap_rows(contacts, *U.shape) @ U.ravel())
    pushed = (contacts.i < N) & (p > 0.0) & (left <= delta0 + CLOSED * float(radii.min()))
    pairs = contacts[np.flatnonzero(pushed)]
    gaps = nearest(pairs, radii, h * U[:, : system.dimension])
    missed = gaps - delta0 > APART * np.minimum(radii[pairs.i], radii[pairs.j])
    if missed.any():
        raise SolveError(
            f"bodies that come no nearer to each other than {gaps[missed].max():.3g} push each other in the "
            f"step to t = {t:.9g}, as it carries them too far past each other; lower time.step"
        )


def nearest(pairs: Contacts, radii: Array, ways: Array) -> Array:
    """The smallest true gap of pairs of bodies, (C,), that go straight ways (N, d) at the same time."""
    touch = radii[pairs.i] + radii[pairs.j]
    start, way = (pairs.D + touch)[:, None] * pairs.n, ways[pairs.j] - ways[pairs.i]
    square = np.maximum(np.einsum("ck,ck->c", way, way), np.finfo(float).tiny)
    part = np.clip(-np.einsum("ck,ck->c", start, way) / square, 0.0, 1.0)
    gaps: Array = np.linalg.norm(start + part[:, None] * way, axis=1) - touch
    return gaps
