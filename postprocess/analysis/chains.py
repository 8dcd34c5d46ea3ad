"""Which chains of discs resist at a step of a run: `python -m fsi.postprocess.analysis.chains RUN [STEP]`.

A rise of the apparent viscosity is traced to its makers: chains of discs linked by gaps below a tenth of the
mean radius, what lubrication dissipates in them, and in a sheared suspension the part of the apparent
viscosity that its forces carry along them (`fsi.postprocess.analysis.links`).

Without STEP it is the one that dissipates most. Prints the chains, and draws them into RUN/chains.png.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from rich.table import Table

from fsi.bodies.configuration import Array, Configuration
from fsi.case.case import Case
from fsi.errors import InputError
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.geometry.periodic import Cell, Channel
from fsi.postprocess import oblique
from fsi.postprocess.analysis.links import Chain, Links, find_chains, find_links
from fsi.postprocess.analysis.strain import strain_rate
from fsi.postprocess.program import program, say
from fsi.postprocess.render.arrangement import arrangement_of, draw_bodies, figure_size
from fsi.postprocess.run.run import open_run

CLOSE = 0.1  # gaps below this many mean radii make a link
_ROWS = 12


@dataclass(frozen=True, slots=True)
class Chains:
    """The chains of one step, that which dissipates most first.

    dissipation: that of the whole flow; shares: of the links in the apparent viscosity, (L,), None where
    there is none.
    """

    case: Case
    step: int
    t: float
    q: Configuration
    links: Links
    chains: tuple[Chain, ...]
    dissipation: float
    shares: Array | None


def read_chains(run: Path, step: int | None = None, close: float = CLOSE) -> Chains:
    """The chains of a step of a run, of the one that dissipates most if none is given.

    Args:
        run: the folder.
        step: its number.
        close: gaps below this many mean radii make a link.

    Raises:
        InputError: not a run folder of discs in the plane, or no such step.
    """
    folder = open_run(run)
    case, steps, bodies = folder.case, folder.columns("steps"), folder.columns("bodies")
    if case.geometry != "planar":
        raise InputError(f'geometry = "{case.geometry}": the lubrication law of discs needs "planar"')
    if "dissipation" not in steps:
        raise InputError(f"{run / 'steps.csv'}: no column dissipation; give a run of the resolved model")
    row = int(np.argmax(steps["dissipation"])) if step is None else _row(steps["step"], step)
    now = bodies["step"] == steps["step"][row]
    centres = np.column_stack([bodies["x"][now], bodies["y"][now]])
    q = Configuration(centres, bodies["angle"][now], case.configuration().radii)
    V = np.column_stack([bodies["V_x"][now], bodies["V_y"][now]])
    t, nothing = float(steps["t"][row]), np.full(len(steps["t"]), np.nan)
    links = find_links(case, q, V, t, close * float(q.radii.mean()))
    return Chains(
        case,
        int(steps["step"][row]),
        t,
        q,
        links,
        find_chains(links, len(q)),
        float(steps["dissipation"][row]),
        _shares(case, t, links, float(steps.get("apparent_viscosity", nothing)[row])),
    )


def _shares(case: Case, t: float, links: Links, apparent_viscosity: float) -> Array | None:
    """What each link carries of the apparent viscosity, which is not a number where there is none."""
    E, container = strain_rate(case, t), case.container()
    if E is None or not np.isfinite(apparent_viscosity) or not isinstance(container, Channel | Cell):
        return None
    shares: Array = links.viscosities(E, case.fluid.viscosity, container.volume) / apparent_viscosity
    return shares


def _row(steps: Array, step: int) -> int:
    found = np.flatnonzero(steps == step)
    if not found.size:
        raise InputError(
            f"step = {step}: the run has the steps {steps[0]:g} to {steps[-1]:g}; give one of them"
        )
    return int(found[0])


def as_table(found: Chains) -> Table:
    """The chains that dissipate most, closed by the sum over all."""
    walls = found.case.container().walls
    table = Table(title=f"chains at step {found.step}, t = {found.t:.6g}")
    headings = ["discs", "walls", "smallest gap", "lubrication", "of the dissipation", "who"]
    if found.shares is not None:
        headings.insert(5, "of the viscosity")
    for heading in headings:
        table.add_column(heading, justify="left" if heading == "who" else "right")
    for chain in found.chains[:_ROWS]:
        names = [found.case.names[k] for k in chain.bodies]
        table.add_row(
            str(len(chain.bodies)), ", ".join(walls[k] for k in chain.walls), f"{chain.smallest_gap:.3g}",
            f"{chain.dissipation:.5g}", f"{chain.dissipation / found.dissipation:.1%}",
            *_of_viscosity(found, chain.links),
            ", ".join(names[:4]) + (", ..." if len(names) > 4 else ""),
        )  # fmt: skip
    total = sum(chain.dissipation for chain in found.chains)
    table.add_section()
    discs, share = sum(len(chain.bodies) for chain in found.chains), total / found.dissipation
    links, who = range(len(found.links.gaps)), "together"
    table.add_row(str(discs), "", "", f"{total:.5g}", f"{share:.1%}", *_of_viscosity(found, links), who)
    return table


def _of_viscosity(found: Chains, links: Sequence[int]) -> list[str]:
    """The cell of the table with what links carry of the apparent viscosity, if there is one."""
    return [] if found.shares is None else [f"{float(found.shares[list(links)].sum()):.1%}"]


def plot(found: Chains, path: Path) -> None:
    """Draw the bodies of a box or cell and their links, by what each dissipates. Raises InputError."""
    container, links, n = found.case.container().at(found.t), found.links, len(found.q)
    if isinstance(container, Cell):
        centres, size = Lattice(container.periods).wrapped(found.q.centres), oblique.size(container)
        draw = partial(oblique.draw_oblique, container=container, q=found.q)
    else:
        arrangement = arrangement_of(found.case, found.q)
        centres, size = arrangement.centres, figure_size(arrangement.cell)
        draw = partial(draw_bodies, arrangement=arrangement)
    first = centres[links.ends[:, 0]]
    # across a periodic side a link is drawn from either body
    second = np.where((links.ends[:, 1] < n)[:, None], centres[links.ends[:, 1] % n], first - links.vectors)
    lines = np.concatenate(
        [np.stack([first, first - links.vectors], 1), np.stack([second, second + links.vectors], 1)]
    )
    of_each = links.dissipation / found.dissipation if found.shares is None else np.abs(found.shares)
    share = np.maximum(np.tile(of_each, 2), 1e-6)
    whole = "dissipation in this gap" if found.shares is None else "apparent viscosity that this gap carries"
    with mpl.rc_context({"font.size": 10}):
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots()
        draw(axes)
        norm = mpl.colors.LogNorm(1e-4, max(1e-3, float(share.max(initial=0.0))))
        widths = 1.0 + 1.2 * np.clip(np.log10(share / 1e-4), 0.0, None)
        drawn = LineCollection(list(lines), cmap="inferno_r", norm=norm, linewidths=widths, zorder=3)
        drawn.set_array(share)
        axes.add_collection(drawn)
        figure.colorbar(drawn, ax=axes, shrink=0.7, label=f"part of the {whole}, by lubrication")
        axes.set_title(f"step {found.step}, t = {found.t:.5g}: gaps below {CLOSE:g} radii", fontsize=10)
        try:
            figure.savefig(path, dpi=130)
        except OSError as error:
            raise InputError(f"{path}: {error.strerror}; give a run folder that can be written") from None


def show(run: Path, step: str | None = None) -> None:
    """Print the table and draw the picture of one step."""
    if step is not None and not step.isdecimal():
        raise InputError(f"step = {step}: not a number; give one of the column step of steps.csv")
    found = read_chains(run, None if step is None else int(step))
    plot(found, run / "chains.png")
    say(as_table(found), f"picture: {run / 'chains.png'}")


main = partial(program, __doc__, show, most=2)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
