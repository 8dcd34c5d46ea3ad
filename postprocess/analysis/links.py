"""Links between close discs, what lubrication dissipates in them, and the chains that they make.

In each close pair, of radii a_i and a_j or of a disc and a wall (a_j infinite), lubrication dissipates

    kappa(d) (G.u)^2,   kappa = 3 sqrt2 pi mu (a/d)^(3/2),   a = a_i a_j / (a_i + a_j),   G.u = d'

d being the gap, d' its rate; for equal discs kappa = (3 pi/2) mu (a_i/d)^(3/2). It is the leading term for
motion along the line of centres: an estimate.

Bodies that are free hardly approach; what a close pair costs a sheared suspension is rather the stress that
its force -kappa d' n carries from the one to the other, r n apart. Of the apparent viscosity it is the part

    kappa d' r n.E.n / (2 mu E:E |Omega|)

with E the mean strain rate and |Omega| the area: positive where the pair is pressed together along the
compression or held together along the extension of the flow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fsi.bodies.configuration import Array, Configuration
from fsi.bodies.forces import separations
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.lubrication.exact import plane_lubrication


@dataclass(frozen=True, slots=True)
class Links:
    """Close pairs, of bodies and then of bodies and walls, L in all.

    ends: the two sides as positions in the bodies followed by the walls, shape (L, 2); vectors: from the
    second centre to the first, or from the wall to the centre, shape (L, 2); gaps: d; rates: d' = G.u;
    tension: kappa(d) d', what lubrication pulls together with; dissipation: kappa(d) d'^2; shapes (L,).
    """

    ends: NDArray[np.intp]
    vectors: Array
    gaps: Array
    rates: Array
    tension: Array
    dissipation: Array

    def viscosities(self, E: Array, viscosity: float, area: float) -> Array:
        """The part of the apparent viscosity that each link carries, (L,).

        Args:
            E: the mean strain rate, (2, 2).
            viscosity: mu.
            area: of fluid and bodies together.
        """
        along = np.einsum("li,ij,lj->l", self.vectors, E, self.vectors)  # r^2 n.E.n
        r = np.linalg.norm(self.vectors, axis=1)
        parts: Array = self.tension * along / r / (2.0 * viscosity * float(np.sum(E**2)) * area)
        return parts


@dataclass(frozen=True, slots=True)
class Chain:
    """Bodies that are linked.

    bodies, walls: their positions in the lists of the case; links: positions in Links; smallest_gap,
    dissipation: of its links.
    """

    bodies: tuple[int, ...]
    walls: tuple[int, ...]
    links: tuple[int, ...]
    smallest_gap: float
    dissipation: float


def find_links(case: Case, q: Configuration, V: Array, t: float, reach: float) -> Links:
    """The links of discs at q that move with V (N, 2) at time t, with gaps up to `reach`.

    An image of a body moves with the body and with the mean flow, `V_j + E away`.
    """
    container = case.container().at(t)
    gaps = find_gaps(q, container, reach)
    (i, j), a = gaps.pairs.T, q.radii
    between = separations(q, gaps)
    unit = between / np.linalg.norm(between, axis=1, keepdims=True)
    body, wall = np.nonzero(gaps.wall_gaps <= reach)
    normal = container.normals(q.centres)[body, wall]
    d = np.concatenate([gaps.pair_gaps, gaps.wall_gaps[body, wall]])
    rates = np.concatenate(
        [
            np.sum(unit * (V[i] - V[j] - container.mean_velocity(gaps.away)), axis=1),
            np.sum(normal * (V[body] - _wall_velocities(case, t)[wall]), axis=1),
        ]
    )
    reduced = np.concatenate([a[i] * a[j] / (a[i] + a[j]), a[body]])
    kappa = plane_lubrication(d, reduced, case.fluid.viscosity)
    to_wall = normal * (gaps.wall_gaps[body, wall] + a[body])[:, None]
    ends = np.concatenate([gaps.pairs, np.column_stack([body, len(q) + wall])])
    return Links(ends, np.concatenate([between, to_wall]), d, rates, kappa * rates, kappa * rates**2)


def _wall_velocities(case: Case, t: float) -> Array:
    """Of each wall, (walls, 2); a shear flow on it is left out, as only what is normal counts."""
    given = case.wall_velocity(t)
    rest = np.zeros(2)
    found = [given[wall].velocity if wall in given else rest for wall in case.container().walls]
    return np.array(found).reshape(-1, 2)


def find_chains(links: Links, bodies: int) -> tuple[Chain, ...]:
    """The components of the graph of links, lone bodies left out; walls do not join what they touch."""
    i, j = links.ends.T
    inner = j < bodies
    graph = coo_array((np.ones(inner.sum()), (i[inner], j[inner])), shape=(bodies, bodies))
    number, label = connected_components(graph, directed=False)
    chains = []
    for k in range(number):
        members, own = np.flatnonzero(label == k), np.flatnonzero(label[i] == k)
        if own.size:
            walls = np.unique(j[own][j[own] >= bodies] - bodies)
            chains.append(
                Chain(
                    tuple(members.tolist()), tuple(walls.tolist()), tuple(own.tolist()),
                    float(links.gaps[own].min()), float(links.dissipation[own].sum()),
                )
            )  # fmt: skip
    return tuple(sorted(chains, key=lambda chain: -chain.dissipation))
