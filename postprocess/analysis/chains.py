"""Which chains of discs resist at a step of a run: what the flow dissipates between close discs.

A rise of the apparent viscosity is traced to its makers: chains of discs linked by gaps below a tenth of the
mean radius, what is dissipated in them (`fsi.postprocess.analysis.links` says how), and in a sheared
suspension the part of the apparent viscosity that lubrication forces carry along them.

A channel is sheared through the chains that reach from wall to wall. Of all such paths of links the chain is
that whose least link dissipates most; it lies in the tree of all links that dissipate most.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.errors import InputError
from fsi.postprocess.analysis.links import (
    CONTACTS,
    NECKS,
    STORED,
    ChainLinks,
    at_stored_gaps,
    find_links,
    in_necks,
)
from fsi.postprocess.analysis.strain import strain_rate
from fsi.postprocess.run.gaps import CLOSE
from fsi.postprocess.run.run import Run
from fsi.report.console import table

type Indices = NDArray[np.integer[Any]]

_ROWS = 12


@dataclass(frozen=True, slots=True)
class Chain:
    """Bodies that are linked.

    Attributes:
        bodies: their positions in the list of the case.
        walls: those that they touch, by position.
        links: positions in ChainLinks.
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
        across: that from wall to wall of a channel, bodies and links in their order; None where none closes.
        measured: whether the flow says what links dissipate; else lubrication does.
    """

    case: Case
    step: int
    t: float
    q: Configuration
    links: ChainLinks
    chains: tuple[Chain, ...]
    dissipation: float
    shares: Array | None
    across: Chain | None
    measured: bool

    def share(self, links: Sequence[int]) -> float | None:
        """Of those links in the apparent viscosity, None where there is none."""
        return None if self.shares is None else float(self.shares[list(links)].sum())


def read_chains(run: Run, step: int | None = None) -> Chains:
    """The chains of discs of a step of a run, of the one that dissipates most if none is given.

    Raises InputError: another kind of run, or no such step.
    """
    case, steps = run.case, run.columns("steps")
    if case.geometry != "planar":
        raise InputError(f'geometry = "{case.geometry}": the lubrication law of discs needs "planar"')
    if case.configuration().shaped:
        raise InputError("bodies: have shapes; the lubrication law of discs needs discs")
    if "dissipation" not in steps:
        raise InputError(
            f"{run.path / 'steps.csv'}: no column dissipation; give a run of a model with a flow"
        )
    if stressed := case.wall_stress(0.0):
        wall = next(iter(stressed))
        raise InputError(
            f"domain.walls.{wall} = {toml_text(case.domain.walls[wall])}: links to a wall that a stress "
            "moves are not told; give a run of which the velocities of walls are given"
        )
    if (mean := case.domain.mean_drive().mean_stress) is not None:
        raise InputError(
            f"domain.stress = {mean!r}: links to images that a stress moves are not told; give a run with "
            "domain.shear"
        )
    row = _row_of(run, steps, step)
    step, t = int(steps["step"][row]), float(steps["t"][row])
    q = run.configuration(step)
    V = run.bodies.loc[run.bodies["step"] == step, ["V_x", "V_y"]].to_numpy()
    links = find_links(case, q, V, t, CLOSE * float(q.radii.mean()))
    if STORED in steps:
        links = at_stored_gaps(run, q, links, {column: float(of[row]) for column, of in steps.items()})
    measured = run.has(NECKS)
    if measured:
        links = replace(links, dissipation=in_necks(run, step, links, float(q.radii.mean())))
    E, shares = strain_rate(case, t), None
    if E is not None and "apparent_viscosity" in steps and np.isfinite(steps["apparent_viscosity"][row]):
        viscosities = links.viscosities(E, case.fluid.viscosity, case.container().volume)
        shares = viscosities / steps["apparent_viscosity"][row]
    chains, dissipation = find_chains(links, len(q)), float(steps["dissipation"][row])
    across = wall_to_wall(links, len(q)) if len(case.container().walls) == 2 else None
    return Chains(case, step, t, q, links, chains, dissipation, shares, across, measured)


def _row_of(run: Run, steps: dict[str, Array], step: int | None) -> int:
    """The row of a step, or of that which dissipates most, of those whose links are known by a series."""
    written = steps["step"]
    if step is None:
        series = CONTACTS if STORED in steps else NECKS
        known = np.isin(written, run.times_of(series).index) | (not run.has(series))
        return int(np.argmax(np.where(known, steps["dissipation"], -np.inf)))
    if step not in written:
        ends = f"the run has the steps {written[0]:g} to {written[-1]:g}"
        raise InputError(f"step = {step}: {ends}; give one of them")
    return int(np.argmax(written == step))


def find_chains(links: ChainLinks, bodies: int) -> tuple[Chain, ...]:
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
            chains.append(_chain(links, members, walls, linked))
    return tuple(sorted(chains, key=lambda chain: -chain.dissipation))


def wall_to_wall(links: ChainLinks, bodies: int) -> Chain | None:
    """The path of links between two walls whose least link dissipates most; None where there is none."""
    order = np.argsort(-links.dissipation, kind="stable")
    ends = links.ends[order]
    # Of several links between the same two the first, which dissipates most, counts.
    _, first = np.unique(ends, axis=0, return_index=True)
    size = bodies + 2
    rank = coo_array((first + 1.0, tuple(ends[first].T)), shape=(size, size))
    tree = minimum_spanning_tree(rank.tocsr())
    _, before = breadth_first_order(tree, bodies, directed=False)
    path = [bodies + 1]
    while path[-1] != bodies:
        if before[path[-1]] < 0:
            return None
        path.append(int(before[path[-1]]))
    way = [order[int(tree[i, j] + tree[j, i]) - 1] for i, j in pairwise(path)]
    return _chain(links, np.array(path[-2:0:-1]), np.arange(2), np.array(way[::-1]))


def _chain(links: ChainLinks, members: Indices, walls: Indices, linked: Indices) -> Chain:
    numbers = tuple(members.tolist()), tuple(walls.tolist()), tuple(linked.tolist())
    return Chain(*numbers, float(links.gaps[linked].min()), float(links.dissipation[linked].sum()))


def chains_table(chains: Chains) -> Table:
    """The chains that dissipate most, closed by the sum over all."""
    headings = ["discs", "walls", "smallest gap", "in necks" if chains.measured else "lubrication"]
    headings += ["of the dissipation"] + ([] if chains.shares is None else ["of the viscosity"])
    listed = table((), headings, title=f"chains at step {chains.step}, t = {chains.t:.6g}")
    listed.add_column("who")
    for chain in chains.chains[:_ROWS]:
        listed.add_row(*_row(chains, chain, 4))
    if chains.across is not None:
        listed.add_section()
        listed.add_row(*_row(chains, chains.across, len(chains.q)))
    listed.add_section()
    discs = sum(len(chain.bodies) for chain in chains.chains)
    total = sum(chain.dissipation for chain in chains.chains)
    every = range(len(chains.links.gaps))
    listed.add_row(str(discs), "", "", *_costs(chains, total, every), "together")
    return listed


def _row(chains: Chains, chain: Chain, shown: int) -> list[str]:
    """A chain, with the names of as many bodies."""
    walls, names = chains.case.container().walls, [chains.case.names[k] for k in chain.bodies]
    touched, gap = ", ".join(walls[k] for k in chain.walls), f"{chain.smallest_gap:.3g}"
    who = ", ".join(names[:shown]) + (", ..." if len(names) > shown else "")
    return [str(len(names)), touched, gap, *_costs(chains, chain.dissipation, chain.links), who]


def _costs(chains: Chains, dissipation: float, links: Sequence[int]) -> list[str]:
    """What links dissipate, its part in the whole, and what they carry of the apparent viscosity, if any."""
    whole = chains.dissipation
    part = f"{dissipation / whole:.1%}" if 0.0 < whole < inf else f"of {'infinite' if whole else 'none'}"
    cells, share = [f"{dissipation:.5g}", part], chains.share(links)
    return cells if share is None else [*cells, f"{share:.1%}"]


def chains_data(chains: Chains) -> dict[str, Any]:
    """All chains, by the names of what they link."""
    dissipation = chains.dissipation if isfinite(chains.dissipation) else None
    data = {"step": chains.step, "t": chains.t, "dissipation": dissipation, "measured": chains.measured}
    across = None if chains.across is None else _data(chains, chains.across)
    return data | {"chains": [_data(chains, chain) for chain in chains.chains], "wall_to_wall": across}


def _data(chains: Chains, chain: Chain) -> dict[str, Any]:
    names, walls = chains.case.names, chains.case.container().walls
    return {
        "bodies": [names[k] for k in chain.bodies],
        "walls": [walls[k] for k in chain.walls],
        "smallest_gap": chain.smallest_gap,
        "dissipation": chain.dissipation,
        "of_the_viscosity": chains.share(chain.links),
    }
