"""Which chains of discs resist at a step of a run: `python -m postprocess.chains RUN [STEP]`.

A rise of the dissipation, and so of the apparent viscosity, is traced to its makers: chains of discs linked
by gaps below a tenth of the mean radius, and what lubrication dissipates in them (`postprocess.links`).

Without STEP it is the one that dissipates most. Prints the chains, and draws them into RUN/chains.png.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from rich.table import Table

from fsi.bodies import Array, Configuration
from fsi.case import Case
from fsi.errors import InputError
from meshes.cell import Cell
from meshes.lattice import Lattice
from postprocess import oblique
from postprocess.arrangement import arrangement_of, draw_bodies, figure_size
from postprocess.links import Chain, Links, find_chains, find_links
from postprocess.program import program, say
from postprocess.run import open_run

CLOSE = 0.1  # gaps below this many mean radii make a link
_ROWS = 12


@dataclass(frozen=True, slots=True)
class Chains:
    """The chains of one step, that which dissipates most first; dissipation: that of the whole flow."""

    case: Case
    step: int
    t: float
    q: Configuration
    links: Links
    chains: tuple[Chain, ...]
    dissipation: float


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
    t = float(steps["t"][row])
    links = find_links(case, q, V, t, close * float(q.radii.mean()))
    return Chains(
        case,
        int(steps["step"][row]),
        t,
        q,
        links,
        find_chains(links, len(q)),
        float(steps["dissipation"][row]),
    )


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
    for heading in ("discs", "walls", "smallest gap", "lubrication", "of the dissipation", "who"):
        table.add_column(heading, justify="left" if heading == "who" else "right")
    for chain in found.chains[:_ROWS]:
        names = [found.case.names[k] for k in chain.bodies]
        table.add_row(
            str(len(chain.bodies)), ", ".join(walls[k] for k in chain.walls), f"{chain.smallest_gap:.3g}",
            f"{chain.dissipation:.5g}", f"{chain.dissipation / found.dissipation:.1%}",
            ", ".join(names[:4]) + (", ..." if len(names) > 4 else ""),
        )  # fmt: skip
    total = sum(chain.dissipation for chain in found.chains)
    table.add_section()
    discs, share = sum(len(chain.bodies) for chain in found.chains), total / found.dissipation
    table.add_row(str(discs), "", "", f"{total:.5g}", f"{share:.1%}", f"all {len(found.chains)} chains")
    return table


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
    share = np.maximum(np.tile(links.dissipation, 2) / found.dissipation, 1e-6)
    with mpl.rc_context({"font.size": 10}):
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots()
        draw(axes)
        norm = mpl.colors.LogNorm(1e-4, max(1e-3, float(share.max(initial=0.0))))
        widths = 1.0 + 1.2 * np.clip(np.log10(share / 1e-4), 0.0, None)
        drawn = LineCollection(list(lines), cmap="inferno_r", norm=norm, linewidths=widths, zorder=3)
        drawn.set_array(share)
        axes.add_collection(drawn)
        figure.colorbar(
            drawn, ax=axes, shrink=0.7, label="part of the dissipation in this gap, by lubrication"
        )
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
