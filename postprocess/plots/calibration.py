"""Draw a calibration folder: samples on the fitted and the exact law, and what is left below."""

from __future__ import annotations

import json
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator

from fsi.bodies.configuration import Array
from fsi.calibration.calibrate import LAW, SUMMARY
from fsi.case.law_file import LawFile, read_law_file
from fsi.lubrication.expansions import EXPONENTS
from fsi.lubrication.named_laws import exact_resistance
from fsi.postprocess.plots.figure import BLUE, GREEN, GREY, ORANGE, saved_figure

_KINDS = ((False, ORANGE, "o", "samples"), (True, GREEN, "s", "held out"))


def plot_calibration(folder: Path, output: Path) -> None:
    """Draw the law and the samples of a folder into a .png, .svg or .pdf file. Raises InputError."""
    data = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    law = read_law_file(folder / LAW)
    gaps = np.array([row["gap"] for row in data["samples"]])
    d = np.geomspace(gaps.min(), gaps.max(), 400)
    exact = _exact(law, d, data["reduced_radius"])
    with saved_figure(output, (8.0, 7.5)) as figure:
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1.2, 1.0))
        _draw_law(upper, law, data, d, exact)
        _draw_rest(lower, law, data, d, exact)


def _exact(law: LawFile, d: Array, a: float) -> Array | None:
    """The exact resistance at gaps d, None where none is known."""
    try:
        K = exact_resistance(law.shape, law.mode, d / a, inf if law.ratio is None else law.ratio)
    except ValueError:
        return None
    exact: Array = law.viscosity * a ** EXPONENTS[law.shape, law.mode] * K
    return exact


def _in_range(law: LawFile, d: Array, a: float) -> Array:
    """Those gaps at which the law holds."""
    smallest, largest = law.law().range
    inside: Array = d[(d / a >= smallest) & (d / a <= largest)]
    return inside


def _draw_law(axes: Axes, law: LawFile, data: dict[str, Any], d: Array, exact: Array | None) -> None:
    """Resistance against the gap."""
    a = data["reduced_radius"]
    if exact is not None:
        axes.loglog(d, exact, color=GREY, lw=5, alpha=0.6, label="exact")
    inside = _in_range(law, d, a)
    axes.loglog(inside, law.law().kappa(inside, a), color=BLUE, lw=1.2, label=f"law ({law.form})")
    for held_out, colour, marker, name in _KINDS:
        rows = [row for row in data["samples"] if row["held_out"] is held_out]
        gap, kappa, error = (np.array([row[key] for row in rows]) for key in ("gap", "kappa", "error"))
        axes.errorbar(gap, kappa, error, fmt=marker, color=colour, mfc="none", label=name)
    axes.set(ylabel="resistance $\\kappa$ = F/U", title=f"{data['case']}: {law.mode} of {law.shape}")
    axes.legend()


def _draw_rest(axes: Axes, law: LawFile, data: dict[str, Any], d: Array, exact: Array | None) -> None:
    """Samples and exact law less the law, relative, with its confidence band."""
    a = data["reduced_radius"]
    inside = _in_range(law, d, a)
    fitted = law.law().kappa(inside, a)
    band = law.error(inside, a)
    if band is not None:
        axes.fill_between(
            inside, -band / fitted, band / fitted, color=BLUE, alpha=0.2, lw=0, label="95 % of the law"
        )
    if exact is not None:
        known = exact[np.isin(d, inside)]
        axes.plot(inside, known / fitted - 1.0, color=GREY, lw=3, alpha=0.7, label="exact")
    for held_out, colour, marker, name in _KINDS:
        rows = [row for row in data["samples"] if row["held_out"] is held_out and row["law"] is not None]
        gap, kappa, error, value = (
            np.array([row[key] for row in rows]) for key in ("gap", "kappa", "error", "law")
        )
        rest, bar = kappa / value - 1.0, error / value
        axes.errorbar(gap, rest, bar, fmt=marker, color=colour, mfc="none", capsize=3, label=name)
    axes.axhline(0.0, color="black", lw=0.6)
    axes.set_xscale("log")
    axes.xaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))  # more would have labels that overlap
    # Linear within the errors of most samples, logarithmic beyond: the band opens up at the last gaps.
    typical = float(np.median([row["error"] / row["kappa"] for row in data["samples"]]))
    axes.set_yscale("symlog", linthresh=10.0 ** np.ceil(np.log10(typical)))
    axes.set(xlabel="gap d", ylabel="relative to the law, less 1")
    axes.legend(ncols=2, fontsize=9)
