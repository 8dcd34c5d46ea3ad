"""What every instant of the reduced model satisfies: relative defects; one above the bound stops a run."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from fsi.bodies.configuration import Array, Configuration
from fsi.errors import SolveError
from fsi.reduced.network import GapNetwork

BOUND = 1e-12
_TINY = np.finfo(float).tiny


def identities(
    network: GapNetwork, q: Configuration, U: Array, alone: Array, force: Array
) -> dict[str, float]:
    """Relative defects of the forces of the gaps, (P,), at velocities U (N, modes).

    Returns:
        momentum: the forces of the gaps between bodies and of the walls sum to zero, over sum |lambda|;
        angular_momentum: so do their moments, 0 if any pair is periodic;
        kernel: a rigid motion of each cluster of bodies changes none of its gaps, in units of its speed;
        residual: of the law `D' = lambda / kappa`, over the largest speed there is, or would be without
        lubrication (alone).
    """
    pairs, d = network.pairs, q.centres.shape[1]
    loads = network.loads(force)
    from_walls = force[pairs.is_wall, None] * pairs.n[pairs.is_wall]
    total = float(np.abs(force).sum()) + _TINY
    sums = loads.sum(axis=0) - from_walls.sum(axis=0)
    defects: dict[str, float] = {"momentum": float(np.abs(sums).max()) / total}
    defects["angular_momentum"] = 0.0
    if not np.any(pairs.shift):
        arm = q.centres - q.centres.mean(axis=0)
        moments = _moments(arm, loads).sum(axis=0)
        moments = moments - _moments(arm[pairs.i[pairs.is_wall]], from_walls).sum(axis=0)
        size = float(np.abs(arm).max()) + float(q.radii.max())
        defects["angular_momentum"] = float(np.abs(moments).max()) / (total * size)
    defects["kernel"] = _kernel(network, q, ~pairs.is_wall)
    rates = network.rates(U[:, :d])
    speed = float(np.abs(U).max() + np.abs(alone).max() + np.abs(pairs.b).max(initial=0.0)) + _TINY
    defects["residual"] = float(np.abs(rates - network.compliance * force).max(initial=0.0)) / speed
    return defects


def _kernel(network: GapNetwork, q: Configuration, between: NDArray[np.bool_]) -> float:
    """Largest |G U| over the largest |U|, for a rigid motion U of each cluster of gaps `between` bodies.

    A cluster that closes on itself through a period can only be translated.
    """
    pairs, N = network.pairs, len(q)
    i, j = pairs.i[between], pairs.j[between]
    clusters, label = connected_components(sp.csr_matrix((np.ones(len(i)), (i, j)), (N, N)), directed=False)
    size = np.bincount(label, minlength=clusters)
    middle = np.column_stack([np.bincount(label, x) / size for x in q.centres.T])
    arm = q.centres - middle[label]
    turns = np.ones(clusters)
    turns[label[i[np.any(pairs.shift[between] != 0.0, axis=1)]]] = 0.0
    spin = turns / np.maximum(np.sqrt(np.bincount(label, (arm**2).sum(axis=1)) / size), q.radii.max())
    turning = np.zeros_like(arm)
    turning[:, 0], turning[:, 1] = -spin[label] * arm[:, 1], spin[label] * arm[:, 0]
    U = 1.0 + turning
    rates = (network.G @ U.ravel())[between]
    return float(np.abs(rates).max(initial=0.0) / np.abs(U).max())


def _moments(arm: Array, force: Array) -> Array:
    """arm x force, shape (n, 1) in the plane, (n, 3) in space."""
    if arm.shape[1] == 2:
        return (arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])[:, None]
    moments: Array = np.cross(arm, force)
    return moments


def relative(defect: float, *terms: float) -> float:
    """|defect| over the sum of the sizes of its terms."""
    return abs(defect) / (sum(map(abs, terms)) + _TINY)


def require(checks: Mapping[str, float], t: float) -> None:
    """Raise SolveError for the first defect above the bound."""
    for name, defect in checks.items():
        if not defect <= BOUND:
            raise SolveError(
                f"reduced model at t = {t:.9g}: {name} is violated by {defect:.1e}, more than {BOUND:g}; "
                "shorten reduced.cutoff or give the bodies more drag"
            )
