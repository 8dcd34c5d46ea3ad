"""The bulk stress of the reduced model: that of the background flow, and what the gaps add.

    Sigma = 2 mu E + 1/|Omega| sum_i S_i,    S_i = sum over the gaps of i of lambda l n (x) n

E is the strain rate of the background, l the distance from the centre to the middle of a gap of two bodies,
or to a wall. For bodies without loads, and walls that move along themselves, `|Omega| Sigma:E` is
the dissipation, with `2 mu E:E |Omega|` of the background. Drag and lubrication are all there is in it: how a
lone body resists strain, 2 phi of discs and 5/2 phi of spheres in the viscosity, is not in the model.
"""

from __future__ import annotations

import numpy as np

from fsi.bodies import Array
from fsi.bulk import BulkStress
from fsi.reduced.pairs import Pairs
from fsi.reduced.space import Space
from meshes.cell import Cell, Channel


def bulk_stress(
    space: Space, pairs: Pairs, force: Array, radii: Array, viscosity: float
) -> BulkStress | None:
    """Sigma in a periodic space, with forces (P,) of the gaps, positive where they open; else None."""
    container = space.container
    if not isinstance(container, Channel | Cell):
        return None
    E = 0.5 * (space.gradient + space.gradient.T)
    S = _stresslets(pairs, force, radii)
    bulk = BulkStress(2.0 * viscosity * E, S, container.area, None)
    rate = float(np.sum(E**2))
    if rate == 0.0:
        return bulk
    apparent = float(np.sum(bulk.mean * E)) / (2.0 * viscosity * rate)
    return BulkStress(bulk.fluid, S, container.area, apparent)


def _stresslets(pairs: Pairs, force: Array, radii: Array) -> Array:
    """S_i, (N, d, d)."""
    between, N = ~pairs.is_wall, len(radii)
    i, j = pairs.i, pairs.j[between]
    middle = np.where(between, 0.5, 1.0) * pairs.gap
    moment = np.concatenate([(radii[i] + middle) * force, (radii[j] + middle[between]) * force[between]])
    body, n = np.concatenate([i, j]), np.concatenate([pairs.n, pairs.n[between]])
    sums = [[np.bincount(body, moment * x * y, minlength=N) for y in n.T] for x in n.T]
    return np.moveaxis(np.array(sums), 2, 0)
