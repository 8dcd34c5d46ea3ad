"""Labels of logarithmic axes: 0.2, 0.5, 1 where they are short, not 2 x 10^-1."""

from __future__ import annotations

from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

_SHORT = 100.0  # ratio of the ends of an axis up to which steps in between have labels


def label_short(axis: Axis) -> None:
    """Label a logarithmic axis, whose ends are set, with plain numbers if shorter than two decades."""
    least, most = axis.get_view_interval()
    if most < _SHORT * least:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.6g}"))
        axis.set_minor_formatter(NullFormatter())
