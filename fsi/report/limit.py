"""The convergence to the gluey limit, as tables and as a picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from fsi.case.case import Case
from fsi.gluey.limit_study import Study


def print_study(console: Console, study: Study) -> None:
    """When it sticks, the errors for each eps, those of the scheme for each number of steps."""
    for begin, end in study.contacts:
        until = f"is released at t = {end:.12g}" if np.isfinite(end) else "is not released"
        console.print(f"sticks at t = {begin:.12g}, {until}", highlight=False)
    table = Table("eps", "sup |q_eps - q|", "over eps", "mean |gamma_eps - gamma|")
    for eps, in_q, in_gamma in zip(study.wanted.eps, study.errors_q, study.errors_gamma, strict=True):
        table.add_row(f"{eps:.0e}", f"{in_q:.3e}", f"{in_q / eps:.3f}", f"{in_gamma:.3e}")
    console.print(table)
    table = Table("steps", "max |q_h - q|", "order")
    before: tuple[int, float] | None = None
    for steps, error in zip(study.wanted.steps, study.scheme, strict=True):
        order = np.log(before[1] / error) / np.log(steps / before[0]) if before and error > 0.0 else np.nan
        table.add_row(str(steps), f"{error:.3e}", "" if np.isnan(order) else f"{order:.3f}")
        before = (steps, error)
    console.print(table)


def draw(case: Case, study: Study, path: Path) -> None:
    """q and gamma over time, for each eps and in the limit."""
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    colours = colormaps["viridis"](np.linspace(0.85, 0.15, len(study.wanted.eps)))
    for eps, solution, colour in zip(study.wanted.eps, study.paths, colours, strict=True):
        label = rf"$\varepsilon = 10^{{{np.log10(eps):.3g}}}$"
        above.plot(solution.t, solution.q, color=colour, label=label)
        below.plot(solution.t, solution.gamma, color=colour, label=label)
    above.plot(study.t, study.q, "k--", linewidth=1.0, label="limit")
    below.plot(study.t, study.gamma, "k--", linewidth=1.0, label="limit")
    above.set_ylabel(r"distance $q_\varepsilon$")
    below.set_ylabel(r"memory $\gamma_\varepsilon = \varepsilon\,\ln q_\varepsilon$")
    below.set_xlabel("time $t$")
    above.set_title(case.name)
    above.legend(frameon=False)
    for axes in (above, below):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=150)
