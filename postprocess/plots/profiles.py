"""The profiles of a macroscopic run at one time: density, velocity and memory over x, one below the other."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib as mpl
from matplotlib.figure import Figure

from fsi.bodies.configuration import Array
from fsi.postprocess.plots.figure import BLUE, STYLE

# Columns of profiles.csv, and what they are.
LABELS = {"rho": r"density $\rho$", "u": "velocity u", "gamma": r"memory $\gamma$"}


def profile_figure(
    title: str, profile: Mapping[str, Array], ends: Mapping[str, tuple[float, float]], size: int
) -> Figure:
    """Draw all columns of a profile against its column x.

    Args:
        title: what stands above them.
        profile: the columns, shapes (n,).
        ends: of the axis of each column.
        size: about as many pixels high and wide.
    """
    names = [name for name in LABELS if name in profile]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.0, 1.2 + 1.7 * len(names)), dpi=size / 6.0, layout="constrained")
        figure.suptitle(title, x=0.02, ha="left", fontsize=13)
        axes = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for name, panel in zip(names, axes, strict=True):
            panel.plot(profile["x"], profile[name], ".-", color=BLUE, ms=2, lw=1.0)
            panel.set(ylabel=LABELS[name], xlim=ends["x"], ylim=ends[name])
        axes[-1].set_xlabel("x")
    return figure
