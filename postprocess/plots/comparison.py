"""Draw `fsi compare`: gaps over time by both models, and the error of gap rates over the gap."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fsi.comparison import LIMITS, RateComparison
from fsi.errors import InputError

_NAMED = 10  # most bodies that get a colour and a name


def plot_comparison(names: Sequence[str], found: RateComparison, path: Path) -> None:
    """Draw into a PNG file. Raises InputError where it cannot be written."""
    with mpl.rc_context({"font.size": 11, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(11.0, 4.5), layout="constrained")
        left, right = figure.subplots(1, 2)
        _draw_gaps(left, names, found)
        _draw_errors(right, found)
        try:
            figure.savefig(path, dpi=160)
        except OSError as error:
            raise InputError(f"{path}: {error.strerror}; give a folder that can be written") from None


def _draw_gaps(axes: Axes, names: Sequence[str], found: RateComparison) -> None:
    """The smallest gap of each body: resolved as a line, reduced dashed."""
    many = len(names) > _NAMED
    for i, name in enumerate(names):
        colour = "#999999" if many else colormaps["tab10"](i)
        axes.semilogy(found.t, found.gap[:, i], color=colour, lw=1.5, label=None if many else name)
        axes.semilogy(found.t, found.reduced_gap[:, i], "--", color=colour, lw=1.0)
    axes.set_xlabel("t")
    axes.set_ylabel("smallest gap")
    axes.set_title("resolved (lines), reduced (dashed)", loc="left", fontsize=12)
    if not many:
        axes.legend(frameon=False, fontsize=9)
    axes.grid(which="major", alpha=0.3)


def _draw_errors(axes: Axes, found: RateComparison) -> None:
    """Relative errors of the rates of all gaps, at the same configurations."""
    axes.loglog(found.sample_gap, np.maximum(found.rate_error, 1e-6), ".", color="#0072b2", ms=4, alpha=0.5)
    for limit in LIMITS:
        axes.axhline(limit, color="black", lw=0.8, ls=":")
        good = found.good_below(limit)
        if good is not None:
            axes.plot([good], [limit], "v", color="#d55e00")
    axes.set_xlabel("gap D")
    axes.set_ylabel("|error of D'| / |D'|")
    axes.set_title("rate of a gap, at the same configuration", loc="left", fontsize=12)
    axes.grid(which="major", alpha=0.3)
