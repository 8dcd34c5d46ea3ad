"""How the cost of a benchmark grows with its size: CPU seconds against N beside a line of slope 1."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fsi.arrays import Array
from fsi.errors import InputError
from fsi.files import content, replace
from fsi.postprocess.plots.figure import COLOURS, LIGHT, Theme, label_short, plain, saved_figure

type Curves = Mapping[str, Sequence[tuple[int, float]]]

_MARKERS = "osD^"
_ROOM = 1.5  # factor by which the axes go beyond what was measured


def write_scaling(path: Path, title: str, size: str, curves: Curves) -> None:
    """Write what was measured, what its size N counts, and pairs (N, CPU seconds) by name, as JSON."""
    measured = {name: [list(pair) for pair in curve] for name, curve in curves.items()}
    text = json.dumps({"benchmark": title, "size": size, "cpu_seconds": measured}, indent=1) + "\n"
    replace(path, text.encode())


def plot_scaling(source: Path, output: Path, theme: Theme = LIGHT) -> None:
    """Draw such a file into a .png, .svg or .pdf file. Raises InputError."""
    title, size, curves = _read(source)
    with saved_figure(output, (6.4, 4.8), theme=theme) as figure:
        axes = figure.subplots()
        for k, (name, curve) in enumerate(curves.items()):
            N, seconds = np.array(sorted(curve), dtype=float).T
            colour, marker = COLOURS[k % len(COLOURS)], _MARKERS[k % len(_MARKERS)]
            axes.plot(N, seconds, marker, color=colour, label=f"{plain(name)}{_slope(N, seconds)}")
            axes.plot(N, seconds[-1] * N / N[-1], "--", lw=1.0, color=colour)
        axes.plot([], [], "k--", lw=1.0, label="in proportion to N, from the largest")
        axes.set(xscale="log", yscale="log", title=plain(title), ylabel="CPU seconds")
        axes.set_xlabel(f"N, number of {plain(size)}")
        axes.set(xlim=_ends(curves, 0), ylim=_ends(curves, 1))
        label_short(axes.xaxis)
        label_short(axes.yaxis)
        axes.legend()


def _curve(pairs: Any) -> list[tuple[int, float]]:
    """Sizes and seconds of a file. Raises TypeError, ValueError: they are none."""
    curve = [(int(N), float(seconds)) for N, seconds in pairs]
    if not curve or not all(0.0 < number < np.inf for pair in curve for number in pair):
        raise ValueError("sizes and seconds are numbers > 0")
    return curve


def _ends(curves: Curves, k: int) -> tuple[float, float]:
    """Ends of the axis of sizes (k = 0), or of seconds (k = 1)."""
    values = [pair[k] for curve in curves.values() for pair in curve]
    return min(values) / _ROOM, max(values) * _ROOM


def _slope(N: Array, seconds: Array) -> str:
    """The exponent fitted to all sizes, where there are two."""
    return f", $N^{{{np.polyfit(np.log(N), np.log(seconds), 1)[0]:.2f}}}$" if len(N) > 1 else ""


def _read(path: Path) -> tuple[str, str, Curves]:
    text = content(path, "give a run folder or the file of a benchmark")
    try:
        data = json.loads(text)
        curves = {str(name): _curve(pairs) for name, pairs in data["cpu_seconds"].items()}
        if not curves:
            raise ValueError("cpu_seconds has no curve")
        return str(data["benchmark"]), str(data["size"]), curves
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        what = f"{path}: not the file of a benchmark ({error})"
        raise InputError(f"{what}; give one that --json has written") from None
