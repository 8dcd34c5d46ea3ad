"""The gaps of one case at several levels over time, as they are and on a logarithmic scale."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from fsi.bodies.configuration import Array

# Colours that the colour-blind tell apart, and lines that grey print does.
STYLES = {
    "resolved": ("#0072b2", "-"),
    "reduced": ("#d55e00", "--"),
    "gluey": ("black", ":"),
    "macroscopic": ("#009e73", "-."),
}


def plot_levels(t: Array, gaps: Mapping[str, Array], path: Path) -> None:
    """Draw the smallest gap of each level, shape (T,), at times t."""
    figure = Figure(figsize=(10.0, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    for level, gap in gaps.items():
        colour, style = STYLES[level]
        left.plot(t, gap, style, color=colour, label=level)
        right.semilogy(t, np.where(gap > 0.0, gap, np.nan), style, color=colour, label=level)
    left.set(xlabel="time", ylabel="smallest gap")
    right.set(xlabel="time", ylabel="smallest gap (none where surfaces touch)")
    left.legend(frameon=False)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=150)
