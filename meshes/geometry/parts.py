"""Places along an outline by parts of its length: its parameter may run much faster here than there.

On a stretch of the curve the speed |x'| is a polynomial through Gauss's points, which Legendre's series has
integrated in closed form; Newton's method finds where its integral is some part of the length.
"""

import numpy as np
from numpy.polynomial import legendre

from fsi.arrays import Array
from fsi.meshes.geometry.placed import Placed

POINTS = 12  # of Gauss's rule on a stretch
ROUNDS = 12  # of Newton's method


def at_parts(body: Placed, start: Array, along: Array, parts: Array) -> Array:
    """The t (n, m) at parts (m,), 0 ... 1, of the lengths of stretches from start to start + along, (n,)."""
    points, _ = legendre.leggauss(POINTS)
    t = start[:, None] + 0.5 * along[:, None] * (1.0 + points)
    speed = np.hypot(*body.at(t.ravel()).dx.T).reshape(t.shape)
    density = legendre.legfit(points, speed.T, POINTS - 1)
    length = legendre.legint(density, lbnd=-1.0)
    wanted = parts * np.sum(length, axis=0)[:, None]  # at 1 all of Legendre's polynomials are 1
    at = np.tile(2.0 * parts - 1.0, (len(start), 1))
    for _ in range(ROUNDS):
        excess = legendre.legval(at, length[:, :, None], tensor=False) - wanted
        at = np.clip(at - excess / legendre.legval(at, density[:, :, None], tensor=False), -1.0, 1.0)
    placed: Array = start[:, None] + 0.5 * along[:, None] * (1.0 + at)
    return placed
