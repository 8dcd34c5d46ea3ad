"""Histories of runs as curves in panels below each other, several runs over each other."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.errors import InputError
from fsi.postprocess.analysis.settling import asymptotic_gap, exact_gap
from fsi.postprocess.analysis.strain import accumulated_strain
from fsi.postprocess.plots.figure import (
    COLOURS,
    LIGHT,
    Theme,
    label_short,
    plain_labels,
    plain_title,
    require_figure,
    saved_figure,
)
from fsi.postprocess.plots.panels import (
    ADDED_VISCOSITY,
    LINEAR,
    PANELS,
    VISCOSITY,
    Asked,
    Curves,
    panel_titles,
)
from fsi.postprocess.run.run import Run

_DASHES = ("-", "--", ":", "-.")
_LAWS: dict[str, dict[str, Any]] = {
    "exact": {"color": "#777777", "lw": 6, "alpha": 0.5},
    "asymptote": {"color": "#777777", "lw": 1.5, "ls": ":"},
}
LOGARITHMIC = 10.0  # ratio of the largest to the smallest value from which on an axis may be logarithmic
_CONSTANT = 1e-6  # relative changes below it are rounding: the axis begins at zero
_LEAST_SPAN = 1e-3  # of the largest value: on shorter axes errors of the elements would look like a trend
_ROUNDING = 1e-12  # of the largest value: what is below it is not drawn on a logarithmic axis
_DENSE = 200  # times of a law, evenly and by powers of ten
_FEW = 5  # rows whose values are marked: one alone has no line
_LONG = 100.0  # the same for the gap, from which on time is logarithmic too: discs slow down like t^-2


@dataclass(frozen=True)
class RunHistory:
    """What is drawn of one run.

    Attributes:
        name: of its folder; of several of one name with their number.
        t: the times, (steps,).
        strain: the strain at those times, of a sheared suspension; else None.
        panels: the curves of each panel by its title.
        laws: times and gaps of the exact law and its asymptote, where they are known.
        case: of the run.
    """

    name: str
    t: Array
    strain: Array | None
    panels: dict[str, Curves]
    laws: dict[str, tuple[Array, Array]]
    case: Case

    def label(self, curve: str) -> str:
        """What tells a curve from all others of several runs; a curve of no body by its panels."""
        if all(len(curves) == 1 for curves in self.panels.values()):
            return self.name
        of_no_body = ",\n".join(title for title, curves in self.panels.items() if "" in curves)
        return f"{self.name}: {curve or of_no_body}"

    def styles(self, title: str) -> dict[str, int]:
        """The number of the style of each curve of a panel: of a body its own, whichever are left out."""
        names, curves = self.case.names, self.panels.get(title, {})
        return {name: names.index(name) if name in names else k for k, name in enumerate(curves)}


def read_strain(run: Run) -> Array | None:
    """The strain at the steps of a sheared suspension, None of other runs.

    As it was found where a stress shears a cell, else as the case gives it.
    """
    if not any(PANELS[title](Asked(run, None, 1)) for title in (VISCOSITY, ADDED_VISCOSITY)):
        return None
    if "strain" in run.steps:
        found: Array = run.steps["strain"].to_numpy()
        return found
    return accumulated_strain(run.case, run.steps["t"].to_numpy())


def read_history(
    run: Run, gap: str | None = None, singly: int = len(COLOURS), curves: str | None = None
) -> RunHistory:
    """The curves of a run that it has; gap and singly as in `Asked`, curves as in `plot_runs`.

    Raises InputError: no such gap.
    """
    if gap is not None and not run.viscous:
        raise InputError(f'--gap {gap}: model = "{run.case.model}" of {run.path} has no such curve; drop it')
    t = run.steps["t"].to_numpy()
    asked = Asked(run, gap, singly, by_name=curves is not None)
    panels = {title: PANELS[title](asked) for title in panel_titles(curves) if title in PANELS}
    panels = {title: curves for title, curves in panels.items() if curves}
    laws = _laws(run.case, t) if run.viscous and gap is None else {}
    return RunHistory(run.path.resolve().name, t, read_strain(run), panels, laws, run.case)


def _laws(case: Case, t: Array) -> dict[str, tuple[Array, Array]]:
    """Times and gaps of the laws of a case up to the last of times t, none where there is no exact law.

    The asymptote begins where it comes below the first gap: at first it is infinite.
    """
    with suppress(InputError):
        later = t[t > 0.0]
        fine = [np.linspace(t[0], t[-1], _DENSE), np.geomspace(later[0], t[-1], _DENSE) if later.size else t]
        fine_t = np.unique(np.concatenate(fine))
        exact, asymptote = exact_gap(case, fine_t), asymptotic_gap(case, fine_t)
        late = asymptote <= exact[0]
        laws = {"exact": (fine_t, exact), "asymptote": (fine_t[late], asymptote[late])}
        return {law: curve for law, curve in laws.items() if curve[0].size}
    return {}


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
    histories = _told_apart([read_history(run, gap, singly, curves) for run in runs])
    asked = panel_titles(curves)
    titles = [title for title in asked if any(title in one.panels for one in histories)]
    if curves is not None and titles != asked:
        lacking = next(title for title in asked if title not in titles)
        each = [Asked(run, gap, singly, by_name=True) for run in runs]
        has = [title for title, read in PANELS.items() if any(read(of_run) for of_run in each)]
        raise InputError(f"--curves {curves}: the run has no {lacking!r}; it has {', '.join(has) or 'none'}")
    if not titles:
        raise InputError(f"{runs[0].path}: the run has no bodies and no apparent viscosity; nothing to draw")
    with saved_figure(output, (8.5, 0.8 + 2.4 * len(titles)), theme=theme) as figure:
        axes = list(figure.subplots(len(titles), 1, sharex=True, squeeze=False)[:, 0])
        if len(histories) == 1:
            axes[0].set_title(plain_title(runs[0].case.name))
        entries: dict[str, Artist] = {}  # each label once
        for title, panel in zip(titles, axes, strict=True):
            for label, line in _draw(panel, title, histories):
                entries.setdefault(label, line)
        _scale_time(axes, histories)
        figure.align_ylabels(axes)
        figure.legend([*entries.values()], plain_labels([*entries]), loc="outside right upper")
    return output


def _told_apart(histories: Sequence[RunHistory]) -> list[RunHistory]:
    """The histories, those whose folders have the same name with a number in the order given."""
    names, told = [history.name for history in histories], []
    for k, (name, history) in enumerate(zip(names, histories, strict=True)):
        number = f" ({names[:k].count(name) + 1})" if names.count(name) > 1 else ""
        told.append(replace(history, name=name + number))
    return told


def _draw(axes: Axes, title: str, histories: Sequence[RunHistory]) -> list[tuple[str, Artist]]:
    """One panel: a colour for each body of one run, or for each of several runs; its lines with names."""
    values, single, named = [], len(histories) == 1, list[tuple[str, Artist]]()
    for k, history in enumerate(histories):
        curves = history.panels.get(title, {})
        for law, curve in history.laws.items() if title == "gap" else ():
            named += [(law, line) for line in axes.plot(*curve, label=law, **_LAWS[law])]
        for name, n in history.styles(title).items():
            value = curves[name]
            colour, dash = COLOURS[(n if single else k) % len(COLOURS)], _DASHES[n % len(_DASHES)]
            label = name if single else history.label(name)
            if single and len(curves) == 1 and name not in history.case.names:  # of no body, or of a gap
                colour = mpl.rcParams["text.color"]
            x, marker = _abscissa(history, histories), "o" if len(value) <= _FEW else ""
            style: dict[str, Any] = {"color": colour, "ls": dash, "lw": 1.5, "marker": marker, "ms": 4.0}
            named += [(label, line) for line in axes.plot(x, value, label=label, **style) if label]
            values.append(value)
    y = np.concatenate(values)
    y = y[np.isfinite(y)]
    if y.size and title not in LINEAR and 0.0 < LOGARITHMIC * y.min() < y.max():
        axes.set_yscale("log")
        axes.set_ylim(max(y.min(), _ROUNDING * y.max()) / 1.3, y.max() * 1.3)
        label_short(axes.yaxis)
    elif y.size and np.ptp(y) < _CONSTANT * np.abs(y).max():
        axes.set_ylim(min(0.0, 1.2 * y.min()), max(0.0, 1.2 * y.max()))
    elif y.size:
        low, high = axes.get_ylim()
        short = max(0.0, _LEAST_SPAN * np.abs(y).max() - (high - low))
        axes.set_ylim(low - 0.5 * short, high + 0.5 * short)
    axes.set_ylabel(title)
    return named


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
    if long and not any(history.case.axisymmetric for history in histories):
        axes[0].set_xscale("log")
        axes[0].set_xlim(left=min(float(history.t[history.t > 0.0][0]) for history in histories))
    axes[-1].set_xlabel("strain" if strained else "t")
    for panel in axes:
        if panel.get_xscale() == "log":
            panel.xaxis.set_minor_formatter(NullFormatter())
