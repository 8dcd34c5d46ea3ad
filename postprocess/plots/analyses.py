"""Figures of `fsi analyse`: chains in their cell, memories of contacts, settling and its exact law."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.ticker import NullFormatter

from fsi.postprocess.analysis.chains import Chains
from fsi.postprocess.analysis.memory import ContactMemories
from fsi.postprocess.analysis.settling import Settling
from fsi.postprocess.plots.arrangement import draw_case
from fsi.postprocess.plots.figure import BLUE, GREY, ORANGE, plain, saved_figure
from fsi.postprocess.run.gaps import CLOSE


def plot_chains(chains: Chains, path: Path) -> None:
    """Draw bodies and their links, by what each costs the flow. Raises InputError as `draw_case`."""
    links, n = chains.links, len(chains.q)
    of_each = links.dissipation / chains.dissipation if chains.shares is None else np.abs(chains.shares)
    share = np.maximum(np.tile(of_each, 2), 1e-6)
    norm = mpl.colors.LogNorm(1e-4, max(1e-3, float(share.max(initial=0.0))))
    widths = 1.0 + 1.2 * np.clip(np.log10(share / 1e-4), 0.0, None)
    what = "dissipation in this gap" if chains.shares is None else "apparent viscosity that this gap carries"
    by = "" if chains.measured and chains.shares is None else ", by lubrication"
    with saved_figure(path, (8.0, 8.0), font=10.0, dpi=130) as figure:
        axes, centres = draw_case(figure, chains.case, chains.q, chains.t)
        first = centres[links.ends[:, 0]]
        # across a periodic side a link is drawn from either body
        other = centres[links.ends[:, 1] % n]
        second = np.where((links.ends[:, 1] < n)[:, None], other, first - links.vectors)
        ends = [np.stack([first, first - links.vectors], 1), np.stack([second, second + links.vectors], 1)]
        style = {"cmap": "inferno_r", "norm": norm, "linewidths": widths, "zorder": 3}
        drawn = LineCollection(list(np.concatenate(ends)), array=share, **style)
        axes.add_collection(drawn)
        figure.colorbar(drawn, ax=axes, shrink=0.7, label=f"part of the {what}{by}")
        title = f"step {chains.step}, t = {chains.t:.5g}: gaps below {CLOSE:g} radii"
        axes.set_title(title, loc="center", fontsize=10)


def plot_memories(memory: ContactMemories, path: Path) -> None:
    """The lag against the stored impulse, and how many contacts are closed. Raises InputError."""
    off = memory.contacts[np.isfinite(memory.contacts["released"])]
    with saved_figure(path, (10.0, 4.2)) as figure:
        left, right = figure.subplots(1, 2)
        left.plot(off["stored"], off["lag"], "o", color=BLUE, ms=4, alpha=0.5)
        left.set(xlabel=r"stored impulse $P = -\gamma$", ylabel="time lag of separation")
        left.set(xlim=(0, None), ylim=(0, None))
        right.step(memory.t, memory.closed, where="post", color=ORANGE)
        right.set(xlabel="time", ylabel="closed contacts", ylim=(0, None))


def plot_settling(history: Settling, path: Path) -> None:
    """Draw the gap, computed and exact, above the difference. Raises InputError."""
    later, a = history.time > 0.0, history.radius
    t, exact, gap = (of[later] for of in (history.time, history.exact / a, history.gap / a))
    with saved_figure(path, (7.0, 6.5)) as figure:
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.5, 1.0])
        upper.loglog(t, exact, color=GREY, lw=5, alpha=0.6, label="exact")
        upper.loglog(t, gap, "o-", color=BLUE, ms=3.5, lw=1, label="computed")
        upper.set(
            ylabel="gap / radius", title=f"{plain(history.body)} settling onto a plane under a constant force"
        )
        upper.legend()
        _draw_difference(lower, history)
        for axis in (upper.xaxis, upper.yaxis, lower.xaxis, lower.yaxis):
            axis.set_minor_formatter(NullFormatter())


def _draw_difference(axes: Axes, history: Settling) -> None:
    """Size of the relative difference against time; open marks where the gap is too small."""
    later = (history.time > 0.0) & (history.difference != 0.0)
    t, size, low = history.time[later], np.abs(history.difference[later]), history.difference[later] < 0.0
    axes.loglog(t, size, color=ORANGE, lw=1)
    axes.loglog(t[~low], size[~low], "o", color=ORANGE, ms=3.5, label="too wide")
    axes.loglog(t[low], size[low], "o", color=ORANGE, mfc="white", ms=3.5, label="too narrow")
    axes.set(xlabel="time", ylabel="relative difference")
    axes.legend(ncols=2)
