"""The nearest configuration in which no gap is narrower than a given one.

The displacements x - q of the centres are the least, in the sum of their squares, with every gap D of bodies,
images and walls at least c: with D linear about the last x this is a problem of least distance,

    min |x - q|^2   with   D_k + G_k (x - x_k) >= c,

solved by non-negative least squares (C. L. Lawson and R. J. Hanson, Solving Least Squares Problems (1974),
chapter 23). Distances of centres are convex, so that each solution has gaps of at least c between bodies.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import find_gaps
from fsi.errors import SolveError
from fsi.meshes.geometry.container import Container

_ROUNDS = 30
# Of the gap: what is left of a violation, and how much room the residual of an infeasible problem leaves.
_TOLERANCE, _INFEASIBLE = 1e-9, 1e-10


def opened(q: Configuration, container: Container, least: float, solid: tuple[str, ...]) -> Configuration:
    """The nearest configuration of discs or spheres with gaps of at least this, q itself where q is one.

    Of walls those count that are `solid` and do not stand for infinity. Raises
    SolveError: there is none near.
    """
    x = q
    for _ in range(_ROUNDS):
        G, gap = _gaps(x, container, 3.0 * least, lubricating(container, solid))
        if gap.min(initial=np.inf) >= least * (1.0 - _TOLERANCE):
            return x
        moved = _least_distance(G, least - gap + G @ (x.centres - q.centres).ravel())
        if moved is None:
            break
        x = replace(q, centres=q.centres + moved.reshape(q.centres.shape))
    raise SolveError(
        f"lubrication.below = {least:g}: the bodies have no room to be moved apart to gaps of this; give a "
        "smaller one, or drop it"
    )


def way_out(q: Configuration, container: Container, least: float, solid: tuple[str, ...]) -> float:
    """How wide the widest gap is around that fluid of the plane which gaps shut in most tightly.

    `least` where gaps below that shut nothing in. Gaps are links between bodies, and walls that meet are
    linked: of links from narrow to wide the first that closes a loop. In a cell loops end at the image where
    they began, as chains from side to side shut nothing in.
    """
    found, near = find_gaps(q, container, least), lubricating(container, solid)
    body, wall = np.nonzero((found.wall_gaps < least) & near)
    links = np.vstack([found.pairs, np.column_stack([body, len(q) + wall])])
    away = np.vstack([found.away, np.zeros((len(body), q.dimension))])
    width = np.append(found.pair_gaps, found.wall_gaps[body, wall])
    part, shift = np.arange(len(q) + len(near)), np.zeros((len(q) + len(near), q.dimension))
    for one, other in container.meetings():
        if near[one] and near[other]:
            part[part == part[len(q) + one]] = part[len(q) + other]
    for k in np.argsort(width):
        one, other = links[k]
        apart = shift[other] + away[k] - shift[one]
        if part[one] != part[other]:
            joined = part == part[one]
            shift[joined] += apart
            part[joined] = part[other]
        elif container.walls or np.abs(apart).max() < least:
            return float(width[k])
    return least


def lubricating(container: Container, solid: tuple[str, ...]) -> NDArray[np.bool_]:
    """Which walls are solid and no part of infinity, (walls,)."""
    return np.array([w in solid and w not in container.far_walls for w in container.walls], dtype=bool)


def _gaps(
    q: Configuration, container: Container, reach: float, near: NDArray[np.bool_]
) -> tuple[Array, Array]:
    """The rows G = grad D over all centres, (P, N d), and D, (P,), of gaps up to a reach."""
    found, (N, d) = find_gaps(q, container, reach), q.centres.shape
    i, j = found.pairs.T
    between = q.centres[i] - q.centres[j] - found.away
    n = between / np.linalg.norm(between, axis=1)[:, None]
    body, wall = np.nonzero((found.wall_gaps <= reach) & near)
    G, pairs = np.zeros((len(i) + len(body), N, d)), np.arange(len(i))
    np.add.at(G, (pairs, i), n)
    np.add.at(G, (pairs, j), -n)
    if len(body):
        G[len(i) + np.arange(len(body)), body] = container.normals(q.centres)[body, wall]
    return G.reshape(len(G), N * d), np.append(found.pair_gaps, found.wall_gaps[body, wall])


def _least_distance(G: Array, h: Array) -> Array | None:
    """The shortest x with G x >= h; None where there is none."""
    import scipy  # late: `fsi check` does without

    scale = float(np.abs(h).max())
    rows = np.vstack([G.T, h / scale])
    target = np.append(np.zeros(G.shape[1]), 1.0)
    dual, _ = scipy.optimize.nnls(rows, target)
    rest = rows @ dual - target
    if -rest[-1] <= _INFEASIBLE:
        return None
    return np.asarray(-scale * rest[:-1] / rest[-1])
