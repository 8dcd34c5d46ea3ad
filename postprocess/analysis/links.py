"""Links of close discs, and what the fluid dissipates in each: by lubrication, or in the necks of pores.

In each close pair, of radii a_i and a_j (of a wall infinite, of a round one -R), lubrication dissipates

    kappa(d) (G.u)^2,   kappa = 3 sqrt2 pi mu (a/d)^(3/2),   a = a_i a_j / (a_i + a_j),   G.u = d'

d being the gap, d' its rate; for equal discs kappa = (3 pi/2) mu (a_i/d)^(3/2). It is the leading term for
motion along the line of centres: an estimate. Reduced runs had a law of their own, which is taken, with the
scheme "distance" at the gaps that they stored. Runs of pores have measured what is dissipated in the fluid of
each neck, by sliding, rolling and flux too.

Bodies that are free hardly approach; what a close pair costs a sheared suspension is rather the stress that
its force -kappa d' n carries from the one to the other, r n apart. Of the apparent viscosity it is the part

    kappa d' r n.E.n / (2 mu E:E |Omega|)

with E the mean strain rate and |Omega| the area: positive where the pair is pressed together along the
compression or held together along the extension of the flow.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.forces import separations
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.case.wall_velocity import WallVelocities
from fsi.errors import InputError
from fsi.lubrication.exact import plane_lubrication
from fsi.postprocess.run.grids import nodes
from fsi.postprocess.run.run import Run
from fsi.reduced.enclosure import overlap
from fsi.reduced.gap_laws import Films, make_laws

NECKS = "necks"  # the series of a run of pores
CONTACTS = "contacts"  # that of a reduced run, with the gaps that it took
STORED = "log10_stored_gap"  # the column of a run that stores them, of the smallest
_SAME = 1e-6  # of a radius: a link and a neck between the same places


@dataclass(frozen=True, slots=True)
class ChainLinks:
    """Close pairs, of bodies and then of bodies and walls, L in all.

    Attributes:
        ends: the two sides as positions in the bodies followed by the walls, shape (L, 2).
        vectors: from the second centre to the first, or from the wall to the centre, shape (L, 2).
        gaps: d, shape (L,).
        rates: d' = G.u, shape (L,).
        tension: kappa(d) d', what lubrication pulls together with, shape (L,).
        dissipation: kappa(d) d'^2, or what the run has measured, shape (L,).
    """

    ends: NDArray[np.intp]
    vectors: Array
    gaps: Array
    rates: Array
    tension: Array
    dissipation: Array

    def viscosities(self, E: Array, viscosity: float, area: float) -> Array:
        """The part of the apparent viscosity that each link carries, (L,).

        E: the mean strain rate, (2, 2); area: of fluid and bodies together.
        """
        along = np.einsum("li,ij,lj->l", self.vectors, E, self.vectors)  # r^2 n.E.n
        dissipated = 2.0 * viscosity * float(np.sum(E**2)) * area
        parts: Array = self.tension * along / np.linalg.norm(self.vectors, axis=1) / dissipated
        return parts


def find_links(case: Case, q: Configuration, V: Array, t: float, reach: float) -> ChainLinks:
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
    of_pairs = np.sum(unit * (V[i] - V[j] - container.mean_velocity(gaps.away)), axis=1)
    to_wall = normal * (gaps.wall_gaps[body, wall] + a[body])[:, None]
    walls = WallVelocities.given(container.walls, case.wall_velocity(t), 2)
    of_walls = np.sum(normal * (V[body] - walls.at(wall, q.centres[body] - to_wall)), axis=1)
    rates = np.concatenate([of_pairs, of_walls])
    ends = np.concatenate([gaps.pairs, np.column_stack([body, len(q) + wall])])
    vectors = np.concatenate([between, to_wall])
    nothing = np.zeros(len(d))
    return _lubricated(case, q, ChainLinks(ends, vectors, d, rates, nothing, nothing), np.log(d))


def _lubricated(case: Case, q: Configuration, links: ChainLinks, x: Array) -> ChainLinks:
    """Links with what lubrication does in them at gaps exp x, (L,)."""
    (i, j), a = links.ends.T, q.radii
    is_wall = j >= len(q)
    other = a[np.where(is_wall, 0, j)]
    radius = a[i] * other / (a[i] + other)
    radius[is_wall] = case.container().reduced_radii(a)[i[is_wall], j[is_wall] - len(q)]
    if case.model == "reduced":
        kappa = make_laws(case).kappa(x, Films(radius, overlap(radius, a[i]), is_wall))
    else:
        kappa = plane_lubrication(np.exp(x), radius, case.fluid.viscosity)
    force = kappa * links.rates
    return replace(links, gaps=np.exp(x), tension=force, dissipation=force * links.rates)


def at_stored_gaps(run: Run, q: Configuration, links: ChainLinks, row: Mapping[str, float]) -> ChainLinks:
    """The links of a run with the scheme "distance" at the gaps that it stored, which drift from the bodies'.

    row: of steps.csv.

    Raises InputError: the run has not written them.
    """
    step, x = int(row["step"]), np.log(links.gaps)
    if step in run.times_of(CONTACTS).index:
        contacts = run.mesh(step, CONTACTS)
        start, end = np.asarray(contacts.points, float)[nodes(contacts)][..., : q.dimension].swapaxes(0, 1)
        places = np.column_stack([q.centres[links.ends[:, 0]], links.vectors]) / q.radii.mean()
        written = cKDTree(np.column_stack([start, start - end]) / q.radii.mean())
        away, nearest = written.query(places)
        stored = np.log(np.maximum(contacts.cell_data["gap"], np.finfo(float).tiny))
        x = np.where(away < _SAME, stored[np.minimum(nearest, len(stored) - 1)], x)
    elif row["pairs"] == 1:
        x = np.full(len(x), row[STORED] * np.log(10.0))
    elif row["pairs"]:
        raise InputError(
            f"step = {step}: the run has not written which gaps it stored there; give a step with fields, or "
            "run it again with output.fields = true"
        )
    return _lubricated(run.case, q, links, x)


def in_necks(run: Run, step: int, links: ChainLinks, size: float) -> Array:
    """What is dissipated in the necks of links, (L,); 0 where another body stands between. Raises InputError.

    size: some radius.
    """
    necks = run.mesh(step, NECKS)
    if not necks.n_cells:
        return np.zeros(len(links.gaps))
    start, end = np.asarray(necks.points, float)[nodes(necks)][..., :2].swapaxes(0, 1)
    i, j, lost = (necks.cell_data[name] for name in ("first", "second", "dissipation"))
    places = [np.column_stack([i, j, (start - end) / size]), np.column_stack([j, i, (end - start) / size])]
    away, nearest = cKDTree(np.concatenate(places)).query(np.column_stack([links.ends, links.vectors / size]))
    return np.where(away < _SAME, np.tile(lost, 2)[nearest], 0.0)
