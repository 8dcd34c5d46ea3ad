"""Which chains of discs resist at a step of a run: links of close discs, and what lubrication costs in them.

A rise of the apparent viscosity is traced to its makers: chains of discs linked by gaps below a tenth of the
mean radius, what lubrication dissipates in them, and in a sheared suspension the part of the apparent
viscosity that its forces carry along them.

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

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fsi.bodies.configuration import Array, Configuration
from fsi.bodies.forces import separations
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.errors import InputError
from fsi.lubrication.exact import plane_lubrication
from fsi.postprocess.analysis.strain import strain_rate
from fsi.postprocess.run.run import Run
from fsi.report.console import table

CLOSE = 0.1  # gaps below this many mean radii make a link
_ROWS = 12


@dataclass(frozen=True, slots=True)
class LubricationLinks:
    """Close pairs, of bodies and then of bodies and walls, L in all.

    Attributes:
        ends: the two sides as positions in the bodies followed by the walls, shape (L, 2).
        vectors: from the second centre to the first, or from the wall to the centre, shape (L, 2).
        gaps: d, shape (L,).
        rates: d' = G.u, shape (L,).
        tension: kappa(d) d', what lubrication pulls together with, shape (L,).
        dissipation: kappa(d) d'^2, shape (L,).
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


@dataclass(frozen=True, slots=True)
class Chain:
    """Bodies that are linked.

    Attributes:
        bodies: their positions in the list of the case.
        walls: those that they touch, by position.
        links: positions in LubricationLinks.
        smallest_gap: of its links.
        dissipation: of its links.
    """

    bodies: tuple[int, ...]
    walls: tuple[int, ...]
    links: tuple[int, ...]
    smallest_gap: float
    dissipation: float


@dataclass(frozen=True, slots=True)
class Chains:
    """The chains of one step.

    Attributes:
        case: of the run.
        step: its number.
        t: its time.
        q: where the bodies are.
        links: all of them.
        chains: that which dissipates most first.
        dissipation: that of the whole flow, infinite where velocities of walls jump.
        shares: of the links in the apparent viscosity, (L,), None where there is none.
    """

    case: Case
    step: int
    t: float
    q: Configuration
    links: LubricationLinks
    chains: tuple[Chain, ...]
    dissipation: float
    shares: Array | None

    def share(self, links: Sequence[int]) -> float | None:
        """Of those links in the apparent viscosity, None where there is none."""
        return None if self.shares is None else float(self.shares[list(links)].sum())


def read_chains(run: Run, step: int | None = None, close: float = CLOSE) -> Chains:
    """The chains of discs of a step of a run, of the one that dissipates most if none is given.

    close: gaps below this many mean radii make a link.

    Raises InputError: another kind of run, or no such step.
    """
    case, steps = run.case, run.columns("steps")
    if case.geometry != "planar":
        raise InputError(f'geometry = "{case.geometry}": the lubrication law of discs needs "planar"')
    if "dissipation" not in steps:
        raise InputError(f"{run.path / 'steps.csv'}: no column dissipation; give a run of the resolved model")
    written = steps["step"]
    if step is not None and step not in written:
        known = f"the run has the steps {written[0]:g} to {written[-1]:g}"
        raise InputError(f"step = {step}: {known}; give one of them")
    row = int(np.argmax(steps["dissipation"] if step is None else written == step))
    step, t = int(written[row]), float(steps["t"][row])
    q = run.configuration(step)
    V = run.bodies.loc[run.bodies["step"] == step, ["V_x", "V_y"]].to_numpy()
    links = find_links(case, q, V, t, close * float(q.radii.mean()))
    E, shares = strain_rate(case, t), None
    if E is not None and "apparent_viscosity" in steps and np.isfinite(steps["apparent_viscosity"][row]):
        viscosities = links.viscosities(E, case.fluid.viscosity, case.container().volume)
        shares = viscosities / steps["apparent_viscosity"][row]
    chains, dissipation = find_chains(links, len(q)), float(steps["dissipation"][row])
    return Chains(case, step, t, q, links, chains, dissipation, shares)


def find_links(case: Case, q: Configuration, V: Array, t: float, reach: float) -> LubricationLinks:
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
    of_walls = np.sum(normal * (V[body] - _wall_velocities(case, t)[wall]), axis=1)
    rates = np.concatenate([of_pairs, of_walls])
    reduced = np.concatenate([a[i] * a[j] / (a[i] + a[j]), a[body]])
    kappa = plane_lubrication(d, reduced, case.fluid.viscosity)
    to_wall = normal * (gaps.wall_gaps[body, wall] + a[body])[:, None]
    ends = np.concatenate([gaps.pairs, np.column_stack([body, len(q) + wall])])
    vectors = np.concatenate([between, to_wall])
    return LubricationLinks(ends, vectors, d, rates, kappa * rates, kappa * rates**2)


def _wall_velocities(case: Case, t: float) -> Array:
    """Of each wall, (walls, 2); a shear flow on it is left out, as only what is normal counts."""
    moving, rest = case.wall_velocity(t), np.zeros(2)
    velocities = [moving[wall].velocity if wall in moving else rest for wall in case.container().walls]
    return np.array(velocities).reshape(-1, 2)


def find_chains(links: LubricationLinks, bodies: int) -> tuple[Chain, ...]:
    """The components of the graph of links, lone bodies left out; walls do not join what they touch."""
    i, j = links.ends.T
    inner = j < bodies
    graph = coo_array((np.ones(inner.sum()), (i[inner], j[inner])), shape=(bodies, bodies))
    number, label = connected_components(graph, directed=False)
    chains = []
    for k in range(number):
        members, linked = np.flatnonzero(label == k), np.flatnonzero(label[i] == k)
        if linked.size:
            walls = np.unique(j[linked][j[linked] >= bodies] - bodies)
            numbers = tuple(members.tolist()), tuple(walls.tolist()), tuple(linked.tolist())
            gap, dissipation = float(links.gaps[linked].min()), float(links.dissipation[linked].sum())
            chains.append(Chain(*numbers, gap, dissipation))
    return tuple(sorted(chains, key=lambda chain: -chain.dissipation))


def chains_table(chains: Chains) -> Table:
    """The chains that dissipate most, closed by the sum over all."""
    walls = chains.case.container().walls
    headings = ["discs", "walls", "smallest gap", "lubrication", "of the dissipation"]
    headings += [] if chains.shares is None else ["of the viscosity"]
    listed = table((), headings, title=f"chains at step {chains.step}, t = {chains.t:.6g}")
    listed.add_column("who")
    for chain in chains.chains[:_ROWS]:
        names = [chains.case.names[k] for k in chain.bodies]
        touched, gap = ", ".join(walls[k] for k in chain.walls), f"{chain.smallest_gap:.3g}"
        who = ", ".join(names[:4]) + (", ..." if len(names) > 4 else "")
        costs = _costs(chains, chain.dissipation, chain.links)
        listed.add_row(str(len(chain.bodies)), touched, gap, *costs, who)
    listed.add_section()
    discs = sum(len(chain.bodies) for chain in chains.chains)
    total = sum(chain.dissipation for chain in chains.chains)
    every = range(len(chains.links.gaps))
    listed.add_row(str(discs), "", "", *_costs(chains, total, every), "together")
    return listed


def _costs(chains: Chains, dissipation: float, links: Sequence[int]) -> list[str]:
    """What links dissipate, its part in the whole, and what they carry of the apparent viscosity, if any."""
    part = f"{dissipation / chains.dissipation:.1%}" if isfinite(chains.dissipation) else "of infinite"
    cells, share = [f"{dissipation:.5g}", part], chains.share(links)
    return cells if share is None else [*cells, f"{share:.1%}"]


def chains_data(chains: Chains) -> dict[str, Any]:
    """All chains, by the names of what they link."""
    names, walls = chains.case.names, chains.case.container().walls
    each = [
        {
            "bodies": [names[k] for k in chain.bodies],
            "walls": [walls[k] for k in chain.walls],
            "smallest_gap": chain.smallest_gap,
            "dissipation": chain.dissipation,
            "of_the_viscosity": chains.share(chain.links),
        }
        for chain in chains.chains
    ]
    dissipation = chains.dissipation if isfinite(chains.dissipation) else None
    return {"step": chains.step, "t": chains.t, "dissipation": dissipation, "chains": each}
