"""Histories of runs as curves: gaps, speeds, loads and apparent viscosity, several runs over each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from fsi.bodies.configuration import Array
from fsi.bodies.gaps import find_gaps
from fsi.errors import InputError
from fsi.postprocess.analysis.settling import asymptotic_gap, exact_gap
from fsi.postprocess.analysis.strain import accumulated_strain
from fsi.postprocess.render.ticks import label_short
from fsi.postprocess.render.view import gap_between, parse_sides
from fsi.postprocess.run.run import Run

SUFFIXES = (".png", ".svg", ".pdf")
# Columns of steps.csv, where there is one, and what they are called; that of the reduced model is only the
# part that lubrication adds.
VISCOSITIES = {
    "apparent_viscosity": "apparent viscosity",
    "lubrication_viscosity": "viscosity added by lubrication",
}
# What is drawn of the limits of vanishing viscosity, by its column of steps.csv.
_LIMIT_PANELS = {
    "contacts": "contacts",
    "largest density": "largest_density",
    "smallest gamma": "smallest_gamma",
    "kinetic energy": "kinetic_energy",
}
_TITLES = ("gap", "speed", "load", *VISCOSITIES.values(), *_LIMIT_PANELS)
# Okabe and Ito: told apart by every eye.
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
_DASHES = ("-", "--", ":", "-.")
_LOGARITHMIC = 10.0  # ratio of the largest to the smallest value from which on an axis is logarithmic
_CONSTANT = 1e-6  # relative changes below it are rounding: the axis begins at zero
_ROUNDING = 1e-12  # of the largest value: what is below it is not drawn on a logarithmic axis
_NO_LOAD = 1e-8  # loads on free bodies are rounding, relative to viscosity times speed
_LONG = 100.0  # the same for the gap, from which on time is logarithmic too: discs slow down like t^-2

type Curves = dict[str, Array]  # values (steps,) by the name of a body, or of a law


@dataclass(frozen=True)
class History:
    """What is drawn of one run: its name, the times, the strain, and the curves of each panel."""

    name: str
    t: Array
    strain: Array | None
    panels: dict[str, Curves]
    laws: Curves
    axisymmetric: bool


def read_history(run: Run, gap: str | None = None, singly: int = len(_COLOURS)) -> History:
    """The curves of a run; gap: two sides as in `plot_runs`. Raises InputError.

    Up to `singly` bodies have a curve each; of more the smallest, median and largest value is shown.
    """
    if not run.has_flow:
        if gap is not None:
            raise InputError(f'--gap {gap}: model = "{run.model}" of {run.path} has no such curve; drop it')
        return _limit_history(run)
    steps, names = run.steps, run.case.names
    panels: dict[str, Curves] = {}
    laws: Curves = {}
    t = steps["t"].to_numpy()
    if names:
        panels["gap"] = _gaps(run, gap, singly)
        speed, load = (_sizes(run.bodies, letter, len(names)) for letter in ("V_", "F_"))
        panels["speed"] = _each(names, speed, singly)
        if load.max() > _NO_LOAD * run.case.fluid.viscosity * speed.max():
            panels["load"] = _each(names, load, singly)
    known = steps.dropna(axis="columns", how="all")
    viscosities = {title: known[column] for column, title in VISCOSITIES.items() if column in known}
    panels |= {title: {"": mu.to_numpy()} for title, mu in viscosities.items()}
    if gap is None:
        try:
            laws = {"exact": exact_gap(run.case, t), "asymptote": asymptotic_gap(run.case, t)}
        except InputError:  # no exact law for this case
            laws = {}
    strain = accumulated_strain(run.case, t) if viscosities else None
    return History(run.path.resolve().name, t, strain, panels, laws, run.case.axisymmetric)


def _limit_history(run: Run) -> History:
    """That of a run without a viscous fluid, bodies or a continuum."""
    steps = run.steps
    panels = {title: {"": steps[name].to_numpy()} for title, name in _LIMIT_PANELS.items() if name in steps}
    return History(run.path.resolve().name, steps["t"].to_numpy(), None, panels, {}, axisymmetric=False)


def _sizes(bodies: pd.DataFrame, letter: str, count: int) -> Array:
    """Lengths of the vectors whose columns begin with that letter, (steps, count)."""
    components = bodies[[name for name in bodies if name.startswith(letter)]].to_numpy()
    sizes: Array = np.linalg.norm(components, axis=1).reshape(-1, count)
    return sizes


def _gaps(run: Run, gap: str | None, singly: int) -> Curves:
    """The smallest gap of each body, or one gap."""
    container, names = run.case.container(), run.case.names
    moments = [
        (run.configuration(step), container.at(t))
        for step, t in zip(run.steps["step"], run.steps["t"], strict=True)
    ]
    if gap is None:
        table = np.array([find_gaps(q, around).smallest_of_each() for q, around in moments])
        return _each(names, np.where(np.isfinite(table), table, np.nan), singly)  # no neighbour in reach
    sides = parse_sides(gap, names, container.walls)
    return {f"gap {gap}": np.array([gap_between(q, around, sides).width for q, around in moments])}


def _each(names: Sequence[str], table: Array, singly: int) -> Curves:
    """Columns of a table (steps, N) by name; of many bodies the smallest, median and largest value."""
    if len(names) <= singly:
        return dict(zip(names, table.T, strict=True))
    least, median, most = np.nanquantile(table, [0.0, 0.5, 1.0], axis=1)
    return {"smallest": least, "median": median, "largest": most}


def plot_runs(runs: Sequence[Run], output: Path, gap: str | None = None) -> None:
    """Draw gap, speed, load and, where there is one, apparent viscosity of runs against time into a file.

    Runs of sheared suspensions are drawn against the strain.

    Args:
        runs: at least one.
        output: .png, .svg or .pdf.
        gap: "3,7" or "disc,bottom", names or numbers; if not given, the smallest gap of each body.

    Raises:
        InputError: unknown suffix or gap, a run without rows, or the disk refuses.
    """
    require_figure(output)
    singly = len(_COLOURS) if len(runs) == 1 else len(_DASHES)
    histories = [read_history(run, gap, singly) for run in runs]
    titles = [title for title in _TITLES if _has(histories, title)]
    if not titles:
        raise InputError(f"{runs[0].path}: the run has no bodies and no apparent viscosity; nothing to draw")
    with mpl.rc_context({"font.size": 11, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(8.5, 0.8 + 2.4 * len(titles)), layout="constrained")
        axes = list(figure.subplots(len(titles), 1, sharex=True, squeeze=False)[:, 0])
        if len(histories) == 1:
            axes[0].set_title(runs[0].name, loc="left", fontsize=12)
        for title, own in zip(titles, axes, strict=True):
            _draw(own, title, histories)
        _scale_time(axes, histories)
        figure.align_ylabels(axes)
        figure.legend(*_legend(axes), loc="outside right upper", frameon=False)
        try:
            figure.savefig(output, dpi=160)
        except OSError as error:
            raise InputError(f"output = {output}: {error.strerror}; choose another path") from None


def require_figure(output: Path) -> None:
    """Raise InputError unless a figure can be written there."""
    if output.suffix not in SUFFIXES or not output.absolute().parent.is_dir():
        raise InputError(
            f"output = {output}: give the path of a .png, .svg or .pdf file in a folder that exists"
        )


def _has(histories: Sequence[History], title: str) -> bool:
    return any(title in history.panels for history in histories)


def _draw(axes: Axes, title: str, histories: Sequence[History]) -> None:
    """One panel: a colour for each body of one run, or for each of several runs."""
    values = []
    for k, history in enumerate(histories):
        if title == "gap":
            _draw_laws(axes, history)
        for n, (name, value) in enumerate(history.panels.get(title, {}).items()):
            single, alone = len(histories) == 1, len(history.panels[title]) == 1
            colour, dash = (
                (_COLOURS[n], _DASHES[n % len(_DASHES)])
                if single
                else (_COLOURS[k % len(_COLOURS)], _DASHES[n])
            )
            label = name if single else history.name if alone else f"{history.name}: {name}"
            if single and not name:
                colour, label = "black", "_nolegend_"
            axes.plot(_abscissa(history, histories), value, dash, color=colour, lw=1.5, label=label)
            values.append(value)
    found = np.concatenate(values)
    found = found[np.isfinite(found)]
    if found.size and found.min() > 0.0 and found.max() > _LOGARITHMIC * found.min():
        axes.set_yscale("log")
        axes.set_ylim(max(found.min(), _ROUNDING * found.max()) / 1.3, found.max() * 1.3)
        label_short(axes.yaxis)
    elif found.size and np.ptp(found) < _CONSTANT * np.abs(found).max():
        axes.set_ylim(0.0, 1.2 * found.max())
    axes.set_ylabel(title)
    axes.grid(which="major", alpha=0.3)


def _abscissa(history: History, histories: Sequence[History]) -> Array:
    """The strain where all runs have one, the time else."""
    if history.strain is None or any(other.strain is None for other in histories):
        return history.t
    return history.strain


def _draw_laws(axes: Axes, history: History) -> None:
    """The exact gap as a broad grey curve, its asymptote dotted."""
    styles = {"exact": {"lw": 6, "alpha": 0.5}, "asymptote": {"lw": 1.5, "ls": ":"}}
    for name, value in history.laws.items():
        axes.plot(history.t, value, color="#777777", label=name, **styles[name])  # type: ignore[arg-type]


def _scale_time(axes: Sequence[Axes], histories: Sequence[History]) -> None:
    """Time is logarithmic where discs close their gaps by powers of ten; spheres do so exponentially."""
    gaps = [value for history in histories for value in history.panels.get("gap", {}).values()]
    strained = all(history.strain is not None for history in histories)
    long = not strained and any(value.max() > _LONG * value.min() for value in gaps)
    if long and not any(history.axisymmetric for history in histories):
        first = min(float(history.t[history.t > 0.0][0]) for history in histories)
        axes[0].set_xscale("log")
        axes[0].set_xlim(left=first)
    axes[-1].set_xlabel("t" if any(history.strain is None for history in histories) else "strain")
    for own in axes:
        if own.get_xscale() == "log":
            own.xaxis.set_minor_formatter(NullFormatter())


def _legend(axes: Sequence[Axes]) -> tuple[list[Artist], list[str]]:
    """Each label once."""
    entries: dict[str, Artist] = {}
    for handle, label in _entries(axes):
        entries.setdefault(label, handle)
    return list(entries.values()), list(entries)


def _entries(axes: Sequence[Axes]) -> Iterator[tuple[Artist, str]]:
    for own in axes:
        yield from zip(*own.get_legend_handles_labels(), strict=True)
