"""One case at all levels: `python -m bench.three_levels FOLDER` runs cases/levels.toml into a new FOLDER.

Two discs are pushed together and pulled apart: resolved Stokes flow with inertia, the reduced model with
the law calibrated from resolved forces, and the gluey limit of their gap (exact, `fsi.gluey.limit`). Prints
the gaps, the differences, and when the limit makes sense: where delta_eps, the film's least gap, is above the
roughness delta of the surfaces; below it they touch before the fluid stops them. Draws FOLDER/levels.png.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from rich.table import Table
from scipy.interpolate import CubicHermiteSpline

from fsi.bodies.configuration import Array
from fsi.case.case import Case, load_case
from fsi.cli.shipped import shipped_cases
from fsi.errors import FsiError
from fsi.gluey.history import Jumping, polynomial
from fsi.gluey.limit import Limit
from fsi.models import make_model
from fsi.postprocess.run.run import open_run
from fsi.report.console import standard_output
from fsi.run import run_case

CASE = shipped_cases() / "levels.toml"
# From `fsi calibrate cases/calibration/equal_discs.toml --set 'calibration.range=[1e-4, 5.0]' --set
# 'calibration.form="table"' --set calibration.samples=40`: it holds up to gaps of five radii.
LAW = CASE.parent / "laws" / "equal_discs.toml"
REDUCED = ('model="reduced"', f'reduced.law="{LAW}"', "reduced.cutoff=5.0", "reduced.drag=0.0")
LEVELS = {"resolved": (), "reduced": REDUCED}


def gaps(folder: Path, t: Array) -> dict[str, Array]:
    """Gap histories at the times t by level. Raises as `run_case`."""
    found = {}
    for level, overrides in LEVELS.items():
        case = load_case(CASE, overrides)
        run_case(case, folder / level, make_model(case))
        table = open_run(folder / level).columns("bodies")
        found[level] = _gap(table, sum(body.radius for body in case.bodies), t)
    return found | {"gluey": limit(load_case(CASE), t[-1]).q(t)}


def _gap(table: dict[str, Array], touching: float, t: Array) -> Array:
    """The gap at t by cubics between steps, which are long where bodies are free; rows alternate."""
    x, V = (np.diff(table[name].reshape(-1, 2))[:, 0] for name in ("x", "V_x"))
    gap: Array = CubicHermiteSpline(table["t"][::2], x - touching, V)(t)
    return gap


def limit(case: Case, end: float) -> Limit:
    """The limit of the gap of two discs on the x axis, `q'' = f_2/m_2 - f_1/m_1`, from rest."""
    first, second = case.bodies
    push = [body.force[0] for body in case.bodies]
    mass = [body.mass for body in case.bodies]
    assert not isinstance(push[0], float | int)
    assert not isinstance(push[1], float | int)
    assert mass[0] is not None
    assert mass[1] is not None
    per_mass = np.array(push[1].values) / mass[1] - np.array(push[0].values) / mass[0]
    f = polynomial(Jumping(times=push[0].times, values=tuple(per_mass.tolist())), end)
    gap = second.position[0] - first.position[0] - first.radius - second.radius
    return Limit.of(gap, 0.0, f)


def as_table(t: Array, found: dict[str, Array]) -> Table:
    """Gaps at some times, and the largest differences from the resolved ones."""
    table = Table(title="gap of the discs")
    for heading in ("t", *found):
        table.add_column(heading, justify="right")
    for k in np.linspace(0, len(t) - 1, 13).astype(int):
        table.add_row(f"{t[k]:g}", *(f"{q[k]:.4e}" for q in found.values()), end_section=k == len(t) - 1)
    away = (f"{np.abs(q - found['resolved']).max():.1e}" for q in found.values())
    table.add_row("sup", *away)
    table.caption = "last line: the largest difference from the resolved gap"
    return table


def plot(t: Array, found: dict[str, Array], path: Path) -> None:
    """The gaps, and their logarithms where the films are thin."""
    figure = Figure(figsize=(10.0, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    styles = {"resolved": ("#0072b2", "-"), "reduced": ("#d55e00", "--"), "gluey": ("black", ":")}
    for level, q in found.items():
        colour, style = styles[level]
        left.plot(t, q, style, color=colour, label=level)
        right.semilogy(t, np.where(q > 0.0, q, np.nan), style, color=colour, label=level)
    left.set(xlabel="time", ylabel="gap")
    right.set(xlabel="time", ylabel="gap (gluey: 0 in contact)")
    left.legend(frameon=False)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=150)


def show(folder: Path) -> None:
    """Run all levels, print the table and draw the plot."""
    t = np.linspace(0.0, 6.0, 601)
    found = gaps(folder, t)
    plot(t, found, folder / "levels.png")
    standard_output().print(as_table(t, found))
    print(
        f"delta_eps = {found['resolved'].min():.1e}: surfaces rougher than this touch, and the gluey model, "
        "which remembers the push in a film, makes no sense for them (give contact.roughness)",
        f"plot: {folder / 'levels.png'}",
        sep="\n",
    )


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    try:
        show(Path(sys.argv[1]))
    except FsiError as error:
        sys.exit(f"error: {error}")
