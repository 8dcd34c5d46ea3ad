"""Averages of a sweep over its first key, with every run behind them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter

from fsi.arrays import Array
from fsi.postprocess.plots.figure import COLOURS, PlainNumbers, plain, saved_figure
from fsi.studies.sweep import Average, SweepPlan, SweepRow, value_text

_MARKERS = "os^Dv<>"
_DECADES = 2.0  # that values span from which on their axis may be logarithmic


def plot_sweep(plan: SweepPlan, rows: Sequence[SweepRow], found: Sequence[Average], path: Path) -> None:
    """A panel for each quantity; bars are the standard deviation of one run over seeds, faint dots the runs.

    Where each point has one run only, bars are its error bars. Values of the first key that are no numbers
    stand side by side, and no lines join them; each combination of the other keys has a colour. Raises
    InputError: the file cannot be written.
    """
    count = len(plan.quantities)
    with saved_figure(path, (5.5 * count, 4.2)) as figure:
        for axes, quantity in zip(np.ravel(figure.subplots(1, count)), plan.quantities, strict=True):
            _draw(axes, plan, rows, [one for one in found if one.quantity == quantity])
            axes.set(ylabel=quantity)
            if len(plan.keys) > 1:
                axes.legend(fontsize=9)


def _draw(axes: Axes, plan: SweepPlan, rows: Sequence[SweepRow], found: Sequence[Average]) -> None:
    values = list(plan.keys[0].values) if plan.keys else [0]
    numeric = all(isinstance(value, int | float) for value in values)
    place = [float(value) for value in values] if numeric else [float(k) for k in range(len(values))]
    curves = len(found) // len(values)
    each, order = max(plan.seeds, 1), np.argsort(place)
    for k in range(curves):
        colour, marker = COLOURS[k % len(COLOURS)], _MARKERS[k % len(_MARKERS)]
        of_curve = [found[i * curves + k] for i in order]
        x = np.array(place)[order]
        others = list(of_curve[0].point.items())[1:]
        label = ", ".join(f"{key} = {value_text(value)}" for key, value in others)
        mean, bars = np.array(
            [(one.mean, one.deviation if plan.averaged else one.error) for one in of_curve]
        ).T
        axes.errorbar(
            x,
            mean,
            np.nan_to_num(bars) if np.isfinite(bars).any() else None,
            color=colour,
            marker=marker,
            ls="-" if numeric else "",
            capsize=3,
            label=plain(label),
        )
        for i, at in zip(order, x, strict=True):
            group = rows[(i * curves + k) * each : (i * curves + k + 1) * each]
            quantity = of_curve[0].quantity
            known = [row.values[quantity].value for row in group if quantity in row.values]
            axes.plot(np.full(len(known), at), known, ".", color=colour, alpha=0.4, ms=5, zorder=1)
    axes.set(xlabel=plain(plan.keys[0].name) if plan.keys else "")
    axes.yaxis.set_major_formatter(PlainNumbers())
    if numeric and _are_decades(np.sort(place)):
        axes.set_xscale("log")
        axes.xaxis.set_minor_formatter(NullFormatter())
    if not numeric or not plan.keys:
        axes.set_xticks(place, [plain(value_text(value)) for value in values] if plan.keys else [""])
        axes.set_xlim(-0.5, len(values) - 0.5)


def _are_decades(x: Array) -> bool:
    """Whether ascending values span decades, and more evenly by their logarithms than by themselves."""
    if x[0] <= 0.0 or x[-1] < 10.0**_DECADES * x[0]:
        return False
    unevenness = [np.diff(of).std() / np.ptp(of) for of in (np.log(x), x)]
    return bool(unevenness[0] < unevenness[1])
