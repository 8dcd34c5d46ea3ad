"""Histories of runs as curves: gaps, speeds, loads and apparent viscosity, several runs over each other.

Each panel is one entry here, or is registered from elsewhere:

    register_panel("dissipation", of_steps("dissipation"))
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter

from fsi.bodies.configuration import PLACES, Array
from fsi.bodies.gaps import smallest_of_each
from fsi.bodies.surface_gap import gap_between
from fsi.errors import InputError
from fsi.postprocess.analysis.settling import asymptotic_gap, exact_gap
from fsi.postprocess.analysis.strain import accumulated_strain
from fsi.postprocess.plots.figure import COLOURS, LIGHT, Theme, label_short, require_figure, saved_figure
from fsi.postprocess.run.gaps import parse_sides
from fsi.postprocess.run.run import Run

_DASHES = ("-", "--", ":", "-.")
_LAWS: dict[str, dict[str, Any]] = {
    "exact": {"color": "#777777", "lw": 6, "alpha": 0.5},
    "asymptote": {"color": "#777777", "lw": 1.5, "ls": ":"},
}
_LOGARITHMIC = 10.0  # ratio of the largest to the smallest value from which on an axis is logarithmic
_CONSTANT = 1e-6  # relative changes below it are rounding: the axis begins at zero
_ROUNDING = 1e-12  # of the largest value: what is below it is not drawn on a logarithmic axis
_NO_LOAD = 1e-8  # loads on free bodies are rounding, relative to viscosity times speed
_LONG = 100.0  # the same for the gap, from which on time is logarithmic too: discs slow down like t^-2

type Curves = dict[str, Array]  # values (steps,) by the name of a body, or of a law; none: nothing to draw


@dataclass(frozen=True)
class Asked:
    """What a panel is asked for.

    Attributes:
        run: what is drawn.
        gap: two sides as in `plot_runs`; None for the smallest gap of each body.
        singly: up to so many bodies have a curve each; of more it is the smallest, median and largest value.
    """

    run: Run
    gap: str | None
    singly: int

    @property
    def bodies(self) -> bool:
        """Whether there are bodies in a fluid."""
        return self.run.viscous and bool(self.run.case.names)

    def each(self, table: Array) -> Curves:
        """Columns of a table (steps, N) by the name of the body."""
        names = self.run.case.names
        if len(names) <= self.singly:
            return dict(zip(names, table.T, strict=True))
        least, median, most = np.nanquantile(table, [0.0, 0.5, 1.0], axis=1)
        N = len(names)
        named = zip(("smallest", "median", "largest"), (least, median, most), strict=True)
        return {f"{what} of {N} bodies": values for what, values in named}

    def place(self, column: str) -> Array:
        """A coordinate or an angle of all bodies, (steps, N)."""
        values: Array = self.run.bodies[column].to_numpy(dtype=float)
        return values.reshape(-1, len(self.run.case.names))

    def sizes(self, letter: str) -> Array:
        """Lengths of the vectors of bodies whose columns begin with that letter, (steps, N)."""
        components = self.run.bodies.filter(regex=f"^{letter}_").to_numpy()
        sizes: Array = np.linalg.norm(components, axis=1).reshape(-1, len(self.run.case.names))
        return sizes


_PANELS: dict[str, Callable[[Asked], Curves]] = {}
_ON_DEMAND: set[str] = set()


def register_panel(title: str, read: Callable[[Asked], Curves], on_demand: bool = False) -> None:
    """Let `fsi plot` draw one more panel of that title, below the others, where there are curves.

    on_demand: only where `--curves` names it.
    """
    _PANELS[title] = read
    if on_demand:
        _ON_DEMAND.add(title)


def panel_titles(curves: str | None) -> list[str]:
    """The panels that "gap,x,angle" names, or those of every figure. Raises InputError: there is none."""
    if curves is None:
        return [title for title in _PANELS if title not in _ON_DEMAND]
    asked = [word.strip() for word in curves.split(",")]
    for title in asked:
        if title not in _PANELS:
            raise InputError(f"--curves {curves}: there is no {title!r}; give some of {', '.join(_PANELS)}")
    return asked


def of_steps(column: str) -> Callable[[Asked], Curves]:
    """The curve of a column of steps.csv, where it has numbers."""

    def read(asked: Asked) -> Curves:
        values = asked.run.steps.get(column)
        return {} if values is None or values.isna().all() else {"": values.to_numpy()}

    return read


def _gaps(asked: Asked) -> Curves:
    """The smallest gap of each body, or one gap."""
    run = asked.run
    if not asked.bodies:
        return {}
    steps, container = run.steps["step"].astype(int), run.case.container()
    moments = ((run.configuration(step), run.container(step)) for step in steps)
    if asked.gap is None:
        table = np.array([smallest_of_each(*moment) for moment in moments])
        return asked.each(np.where(np.isfinite(table), table, np.nan))  # a lone body, without walls
    sides = parse_sides(asked.gap, run.case.names, container.walls)
    return {f"gap {asked.gap}": np.array([gap_between(*moment, sides).width for moment in moments])}


def _loads(asked: Asked) -> Curves:
    """On each body, where any is loaded."""
    if not asked.bodies:
        return {}
    load, speed = asked.sizes("F"), asked.sizes("V")
    none = load.max() <= _NO_LOAD * asked.run.case.fluid.viscosity * speed.max()
    return {} if none else asked.each(load)


VISCOSITY = "apparent viscosity"
ADDED_VISCOSITY = "viscosity added by lubrication"  # that of the reduced model: only the part that this adds
register_panel("gap", _gaps)
register_panel("speed", lambda asked: asked.each(asked.sizes("V")) if asked.bodies else {})
register_panel("load", _loads)
register_panel(VISCOSITY, of_steps("apparent_viscosity"))
register_panel("order parameter", of_steps("order_parameter"))
register_panel("tumbling rate", of_steps("tumbling_rate"))
register_panel(ADDED_VISCOSITY, of_steps("lubrication_viscosity"))


def _place(column: str) -> Callable[[Asked], Curves]:
    """Where the bodies are, in one coordinate or angle that they have."""

    def read(asked: Asked) -> Curves:
        has = bool(asked.run.case.names) and column in asked.run.bodies
        return asked.each(asked.place(column)) if has else {}

    return read


for _column in dict.fromkeys(PLACES[2] + PLACES[3]):
    register_panel(_column, _place(_column), on_demand=True)
for _column in ("contacts", "largest_density", "smallest_gamma", "kinetic_energy"):  # of vanishing viscosity
    register_panel(_column.replace("_", " "), of_steps(_column))


@dataclass(frozen=True)
class RunHistory:
    """What is drawn of one run.

    Attributes:
        name: of its folder.
        t: the times, (steps,).
        strain: the strain at those times, of a sheared suspension; else None.
        panels: the curves of each panel by its title.
        laws: exact and asymptotic gaps, where they are known.
        axisymmetric: whether its bodies are spheres on an axis.
    """

    name: str
    t: Array
    strain: Array | None
    panels: dict[str, Curves]
    laws: Curves
    axisymmetric: bool


def _strain(run: Run, t: Array) -> Array | None:
    """As it was found where a stress shears a cell, else as the case gives it."""
    return run.steps["strain"].to_numpy() if "strain" in run.steps else accumulated_strain(run.case, t)


def read_history(
    run: Run, gap: str | None = None, singly: int = len(COLOURS), curves: str | None = None
) -> RunHistory:
    """The curves of a run; gap and singly as in `Asked`, curves as in `plot_runs`. Raises InputError."""
    if gap is not None and not run.viscous:
        raise InputError(f'--gap {gap}: model = "{run.case.model}" of {run.path} has no such curve; drop it')
    t, laws = run.steps["t"].to_numpy(), {}
    panels = {title: _PANELS[title](Asked(run, gap, singly)) for title in panel_titles(curves)}
    panels = {title: curves for title, curves in panels.items() if curves}
    if run.viscous and gap is None:
        with suppress(InputError):  # no exact law for this case
            laws = {"exact": exact_gap(run.case, t), "asymptote": asymptotic_gap(run.case, t)}
    sheared = VISCOSITY in panels or ADDED_VISCOSITY in panels
    strain = _strain(run, t) if sheared else None
    return RunHistory(run.path.resolve().name, t, strain, panels, laws, run.case.axisymmetric)


def plot_runs(
    runs: Sequence[Run],
    output: Path,
    gap: str | None = None,
    curves: str | None = None,
    theme: Theme = LIGHT,
) -> Path:
    """Draw gap, speed, load and, where there is one, apparent viscosity of runs against time; gives the file.

    Runs of sheared suspensions are drawn against the strain. The file is a .png, .svg or .pdf.

    gap: "3,7" or "disc,bottom", names or numbers; if not given, the smallest gap of each body.
    curves: "gap,x,angle", the titles of panels; if not given, those that every figure has.

    Raises InputError: unknown suffix, gap or curve, a run without rows, or the disk refuses.
    """
    require_figure(output)
    singly = len(COLOURS) if len(runs) == 1 else len(_DASHES)
    histories = [read_history(run, gap, singly, curves) for run in runs]
    asked = panel_titles(curves)
    titles = [title for title in asked if any(title in one.panels for one in histories)]
    if curves is not None and titles != asked:
        lacking = next(title for title in asked if title not in titles)
        has = [t for t, read in _PANELS.items() if any(read(Asked(run, gap, singly)) for run in runs)]
        raise InputError(f"--curves {curves}: the run has no {lacking!r}; it has {', '.join(has) or 'none'}")
    if not titles:
        raise InputError(f"{runs[0].path}: the run has no bodies and no apparent viscosity; nothing to draw")
    with saved_figure(output, (8.5, 0.8 + 2.4 * len(titles)), theme=theme) as figure:
        axes = list(figure.subplots(len(titles), 1, sharex=True, squeeze=False)[:, 0])
        if len(histories) == 1:
            axes[0].set_title(runs[0].case.name)
        for title, panel in zip(titles, axes, strict=True):
            _draw(panel, title, histories)
        _scale_time(axes, histories)
        figure.align_ylabels(axes)
        entries: dict[str, Artist] = {}  # each label once
        for panel in axes:
            for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
                entries.setdefault(label, handle)
        figure.legend(list(entries.values()), list(entries), loc="outside right upper")
    return output


def _draw(axes: Axes, title: str, histories: Sequence[RunHistory]) -> None:
    """One panel: a colour for each body of one run, or for each of several runs."""
    values, single = [], len(histories) == 1
    for k, history in enumerate(histories):
        curves = history.panels.get(title, {})
        for law, value in history.laws.items() if title == "gap" else ():
            axes.plot(history.t, value, label=law, **_LAWS[law])
        for n, (name, value) in enumerate(curves.items()):
            colour, dash = COLOURS[n if single else k % len(COLOURS)], _DASHES[n % len(_DASHES)]
            label = name if single else history.name if len(curves) == 1 else f"{history.name}: {name}"
            if single and not name:
                colour, label = mpl.rcParams["text.color"], "_nolegend_"
            axes.plot(_abscissa(history, histories), value, dash, color=colour, lw=1.5, label=label)
            values.append(value)
    y = np.concatenate(values)
    y = y[np.isfinite(y)]
    if y.size and y.min() > 0.0 and y.max() > _LOGARITHMIC * y.min():
        axes.set_yscale("log")
        axes.set_ylim(max(y.min(), _ROUNDING * y.max()) / 1.3, y.max() * 1.3)
        label_short(axes.yaxis)
    elif y.size and np.ptp(y) < _CONSTANT * np.abs(y).max():
        axes.set_ylim(0.0, 1.2 * y.max())
    axes.set_ylabel(title)


def _abscissa(history: RunHistory, histories: Sequence[RunHistory]) -> Array:
    """The strain where all runs have one, the time else."""
    if history.strain is None or any(other.strain is None for other in histories):
        return history.t
    return history.strain


def _scale_time(axes: Sequence[Axes], histories: Sequence[RunHistory]) -> None:
    """Time is logarithmic where discs close their gaps by powers of ten; spheres do so exponentially."""
    gaps = [value for history in histories for value in history.panels.get("gap", {}).values()]
    strained = all(history.strain is not None for history in histories)
    long = not strained and any(value.max() > _LONG * value.min() for value in gaps)
    if long and not any(history.axisymmetric for history in histories):
        axes[0].set_xscale("log")
        axes[0].set_xlim(left=min(float(history.t[history.t > 0.0][0]) for history in histories))
    axes[-1].set_xlabel("strain" if strained else "t")
    for panel in axes:
        if panel.get_xscale() == "log":
            panel.xaxis.set_minor_formatter(NullFormatter())
