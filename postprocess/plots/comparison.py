"""Draw `fsi compare`: gaps over time at several levels, and the error of gap rates over the gap."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fsi.bodies.configuration import Array
from fsi.comparison import LIMITS, RateComparison
from fsi.postprocess.plots.figure import BLUE, GREY, ORANGE, saved_figure

_NAMED = 10  # most bodies that get a colour and a name
# Colours that the colour-blind tell apart, and lines that grey print does.
_STYLES = {
    "resolved": ("#0072b2", "-"),
    "reduced": ("#d55e00", "--"),
    "gluey": ("black", ":"),
    "macroscopic": ("#009e73", "-."),
}


def plot_comparison(names: Sequence[str], comparison: RateComparison, path: Path) -> None:
    """Draw into a PNG file. Raises InputError where it cannot be written."""
    with saved_figure(path, (11.0, 4.5)) as figure:
        left, right = figure.subplots(1, 2)
        _draw_gaps(left, names, comparison)
        _draw_errors(right, comparison)


def _draw_gaps(axes: Axes, names: Sequence[str], comparison: RateComparison) -> None:
    """The smallest gap of each body: resolved as a line, reduced dashed."""
    many = len(names) > _NAMED
    for i, name in enumerate(names):
        colour = GREY if many else colormaps["tab10"](i)
        axes.semilogy(comparison.t, comparison.gap[:, i], color=colour, lw=1.5, label=None if many else name)
        axes.semilogy(comparison.t, comparison.reduced_gap[:, i], "--", color=colour, lw=1.0)
    axes.set(xlabel="t", ylabel="smallest gap", title="resolved (lines), reduced (dashed)")
    if not many:
        axes.legend(fontsize=9)


def _draw_errors(axes: Axes, comparison: RateComparison) -> None:
    """Relative errors of the rates of all gaps, at the same configurations."""
    error = np.maximum(comparison.rate_error, 1e-6)
    axes.loglog(comparison.sample_gap, error, ".", color=BLUE, ms=4, alpha=0.5)
    for limit in LIMITS:
        axes.axhline(limit, color="black", lw=0.8, ls=":")
        if (good := comparison.good_below(limit)) is not None:
            axes.plot([good], [limit], "v", color=ORANGE)
    axes.set(xlabel="gap D", ylabel="|error of D'| / |D'|", title="rate of a gap, at the same configuration")


def plot_levels(t: Array, gaps: Mapping[str, Array], path: Path) -> None:
    """Draw the smallest gap of each level, shape (T,), at times t."""
    figure = Figure(figsize=(10.0, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    for level, gap in gaps.items():
        colour, style = _STYLES[level]
        left.plot(t, gap, style, color=colour, label=level)
        right.semilogy(t, np.where(gap > 0.0, gap, np.nan), style, color=colour, label=level)
    left.set(xlabel="time", ylabel="smallest gap")
    right.set(xlabel="time", ylabel="smallest gap (none where surfaces touch)")
    left.legend(frameon=False)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=150)
