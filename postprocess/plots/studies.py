"""Figures of studies that use models: `fsi compare`, `fsi limit` and `fsi validate`.

Of a comparison gaps over time at several levels, and the error of gap rates over the gap; of a limit the gap
and its memory as the viscosity vanishes; of a validation resolved forces on the exact curve and asymptotes,
all errors below.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from fsi.arrays import Array
from fsi.comparison.motion import LIMITS, RateComparison, Trajectories
from fsi.comparison.viscosity import ViscosityHistories
from fsi.gluey.limit_study import Study
from fsi.lubrication.expansions import expansion
from fsi.lubrication.spheres import normal_resistance
from fsi.postprocess.plots.figure import BLUE, COLOURS, GREY, ORANGE, label_short, plain, saved_figure
from fsi.postprocess.plots.histories import LOGARITHMIC, read_strain
from fsi.postprocess.run.run import Run
from fsi.validation.rows import TERMS, Row, of_spheres

_NAMED = 10  # most bodies that get a colour and a name
_CASE, _SPACE = 0.2, 0.2  # inches for the name of a case, and the part of it between the rows of two
_FLOOR = 1e-14  # where a true error of zero is drawn
_MARKS = 8  # on a curve
_MARKERS = "os^Dv<>Ph*"
# Colours that the colour-blind tell apart, lines and marks that grey print does; where curves lie on each
# other the broad ones are below, and marks stand at different places.
_STYLES: dict[str, dict[str, Any]] = {
    "resolved": {"color": "#0072b2", "ls": "-", "lw": 4.0, "marker": "o"},
    "pores": {"color": "#cc79a7", "ls": "-", "lw": 2.5, "marker": "D"},
    "reduced": {"color": "#d55e00", "ls": "--", "lw": 1.8, "marker": "s"},
    "gluey": {"color": "#000000", "ls": "-", "lw": 1.4, "marker": "^"},
    "macroscopic": {"color": "#009e73", "ls": "--", "lw": 1.0, "marker": "v"},
}


def _style(level: str, t: Array) -> dict[str, Any]:
    """How the curve of a level over so many times is drawn."""
    marks = max(1, len(t) // _MARKS)
    first = [*_STYLES].index(level) * marks // len(_STYLES)
    return _STYLES[level] | {"markevery": (first, marks), "mfc": "white", "ms": 5.0}


def plot_comparison(names: Sequence[str], comparison: RateComparison, path: Path) -> None:
    """Draw into a PNG file. Raises InputError where it cannot be written."""
    with saved_figure(path, (11.0, 4.5)) as figure:
        left, right = figure.subplots(1, 2)
        _draw_gaps(left, names, comparison)
        _draw_rate_errors(right, comparison)


def _draw_gaps(axes: Axes, names: Sequence[str], comparison: RateComparison) -> None:
    """The smallest gap of each body: resolved as a line, reduced dashed, each with marks at its own times."""
    many, marks = len(names) > _NAMED, max(1, len(comparison.t) // _MARKS)
    for i, name in enumerate(names):
        # Two bodies that share their smallest gap have one curve: marks of both are seen on it.
        own: dict[str, Any] = (
            {"color": GREY} if many else {"color": COLOURS[i % len(COLOURS)], "marker": _MARKERS[i]}
        )
        own |= {"markevery": (i * marks // len(names), marks), "mfc": "none"}
        t, label = comparison.t, None if many else plain(name)
        axes.semilogy(t, comparison.gap[:, i], lw=1.5, label=label, **own)
        axes.semilogy(t, comparison.reduced_gap[:, i], "--", lw=1.0, **own)
    axes.set(xlabel="t", ylabel="smallest gap of each body", title="resolved (lines), reduced (dashed)")
    label_short(axes.yaxis)
    if not many:
        axes.legend(fontsize=9)


def _draw_rate_errors(axes: Axes, comparison: RateComparison) -> None:
    """Relative errors of the rates of all gaps, at the same configurations."""
    axes.set(xlabel="gap D", ylabel="|error of D'| / |D'|", title="rate of a gap, at the same configuration")
    if not len(comparison.sample_gap):
        axes.text(0.5, 0.5, "no gap within reach", ha="center", transform=axes.transAxes)
        return
    error = np.maximum(comparison.rate_error, 1e-6)
    axes.loglog(comparison.sample_gap, error, ".", color=BLUE, ms=4, alpha=0.5)
    for limit in LIMITS:
        axes.axhline(limit, color="black", lw=0.8, ls=":")
        if (good := comparison.good_below(limit)) is not None:
            axes.plot([good], [limit], "v", color=ORANGE)
    label_short(axes.xaxis)
    label_short(axes.yaxis)


def plot_levels(
    runs: Mapping[str, Run], paths: Trajectories, viscosities: ViscosityHistories | None, path: Path
) -> None:
    """Draw the smallest gap of each level, and their apparent viscosities over each other, into a PNG file.

    Over the strain where all levels have one. Gaps whose positive values span a ratio above 10 are drawn
    on a logarithmic axis too. Raises InputError where it cannot be written.
    """
    strains = {level: strain for level, run in runs.items() if (strain := read_strain(run)) is not None}

    def over(level: str, t: Array) -> Array:
        if len(strains) < len(runs):
            return t
        return np.asarray(np.interp(t, runs[level].steps["t"].to_numpy(), strains[level]))

    gaps = {level: np.where(gap > 0.0, gap, np.nan) for level, gap in paths.smallest.items()}
    known = np.concatenate([gap[np.isfinite(gap)] for gap in gaps.values()])
    curves = {"smallest gap": (paths.t, paths.smallest)}
    if known.size and LOGARITHMIC * known.min() < known.max():
        curves["smallest gap above 0"] = paths.t, gaps
    if viscosities is not None:
        curves["apparent viscosity"] = viscosities.t, dict(viscosities.mu)
    with saved_figure(path, (7.0, 2.7 * len(curves))) as figure:
        panels = figure.subplots(len(curves), 1, sharex=True, squeeze=False)[:, 0]
        for axes, (title, (t, values)) in zip(panels, curves.items(), strict=True):
            for level, value in values.items():
                axes.plot(over(level, t), value, label=level, **_style(level, t))
            axes.set(ylabel=title)
            if title.endswith("above 0"):
                axes.set_yscale("log")
                label_short(axes.yaxis)
        panels[-1].set(xlabel="strain" if len(strains) == len(runs) else "t")
        panels[0].legend()


def plot_limit(name: str, study: Study, path: Path) -> None:
    """Draw q and gamma over time, for each eps and in the limit; name: of the case. Raises InputError."""
    colours = mpl.colormaps["viridis"](np.linspace(0.85, 0.15, len(study.wanted.eps)))
    with saved_figure(path, (7.0, 6.0)) as figure:
        above, below = figure.subplots(2, 1, sharex=True)
        for eps, solution, colour in zip(study.wanted.eps, study.paths, colours, strict=True):
            label = rf"$\varepsilon = 10^{{{np.log10(eps):.3g}}}$"
            above.plot(solution.t, solution.q, color=colour, label=label)
            below.plot(solution.t, solution.gamma, color=colour)
        above.plot(study.t, study.q, "k--", lw=1.0, label="limit")
        below.plot(study.t, study.gamma, "k--", lw=1.0)
        above.set(ylabel=r"distance $q_\varepsilon$", title=plain(name))
        below.set(
            ylabel=r"memory $\gamma_\varepsilon = \varepsilon\,\ln(q_\varepsilon/a)$", xlabel="time $t$"
        )
        above.legend()


def plot_rows(rows: Sequence[Row], path: Path) -> None:
    """Draw the rows into a PNG file. Raises InputError where it cannot be written."""
    solved = [row for row in rows if not row.failure]
    heights = (3.5, max(2.5, _CASE * len({row.case for row in solved})))
    with saved_figure(path, (9.0, sum(heights) + 0.5)) as figure:
        upper, lower = figure.subplots(2, 1, height_ratios=heights)
        _draw_sphere(upper, of_spheres(solved))
        _draw_errors(lower, solved)


def _draw_sphere(axes: Axes, rows: Sequence[Row]) -> None:
    """Force over 6 pi mu a^2 U / q against the gap over the radius."""
    s = np.geomspace(1e-6, 20.0, 300)
    series = {terms: expansion("spheres", "squeeze", np.inf, terms) for terms in TERMS}
    leading = series[1].value(s)
    axes.loglog(s, normal_resistance(s, 1.0, 1.0) / leading, color=GREY, lw=5, alpha=0.6, label="exact")
    for colour, (terms, name) in zip(COLOURS, TERMS.items(), strict=False):
        axes.loglog(s, series[terms].value(s) / leading, "--", color=colour, lw=1, label=name)
    for marker, case in zip("ox+", dict.fromkeys(row.case for row in rows), strict=False):
        of_case = ([row.gap, row.value / row.reference] for row in rows if row.case == case)
        gap, ratio = np.array([*of_case]).T
        exact = normal_resistance(gap, 1.0, 1.0) / series[1].value(gap)
        axes.loglog(gap, ratio * exact, marker, color="black", mfc="none", label=case)
    axes.set(ylim=(0.8, 20.0), xlabel="gap / radius", ylabel="force / leading term")
    axes.set_title("a sphere moving along the normal of a plane")
    axes.legend(ncols=2)


def _draw_errors(axes: Axes, rows: Sequence[Row]) -> None:
    """True errors of all rows, case below case, with bars from a tenth of the estimate to the estimate."""
    names, place = np.array([row.case for row in rows]), np.empty(len(rows))
    cases = [*dict.fromkeys(names.tolist())]
    for k, case in enumerate(cases):
        place[names == case] = k + _within(int(np.count_nonzero(names == case)))
    bar = np.array([row.error_bar for row in rows])
    axes.hlines(place, 0.1 * bar, bar, color=COLOURS[0], lw=2, alpha=0.5, label="estimate, down to a tenth")
    axes.plot([max(row.true_error, _FLOOR) for row in rows], place, "o", color=COLOURS[1], ms=3, label="true")
    axes.plot([row.rtol for row in rows], place, "|", color="black", label="tolerance")
    axes.set(xscale="log", xlabel="relative error", ylim=(max(len(cases), 1) - 0.5, -0.5))
    axes.set_yticks(range(len(cases)), cases, fontsize=8)
    axes.legend(fontsize=8)
    axes.grid(visible=False, axis="y")


def _within(count: int) -> Array:
    """Where so many rows of a case are drawn, about its name."""
    return (1.0 - _SPACE) * ((np.arange(count) + 0.5) / count - 0.5)
