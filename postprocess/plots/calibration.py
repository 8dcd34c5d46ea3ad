"""Draw a calibration folder: samples on the fitted and the exact law, and what is left below."""

from math import inf
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator

from fsi.arrays import Array
from fsi.calibration.calibrate import LAW, SUMMARY
from fsi.case.law_file import LawFile, read_law_file
from fsi.errors import InputError
from fsi.files import json_of
from fsi.lubrication.expansions import EXPONENTS
from fsi.lubrication.named_laws import exact_resistance
from fsi.postprocess.plots.figure import BLUE, GREEN, GREY, LIGHT, ORANGE, Theme, plain, saved_figure

_COLUMNS = ("gap", "kappa", "error")
_REMEDY = "give the folder of a calibration"
_KINDS = ((False, ORANGE, "o", "samples"), (True, GREEN, "s", "held out"))


def plot_calibration(folder: Path, output: Path, theme: Theme = LIGHT) -> None:
    """Draw the law and the samples of a folder into a .png, .svg or .pdf file. Raises InputError."""
    data = json_of(folder / SUMMARY, _REMEDY)
    law = read_law_file(folder / LAW)
    try:
        a, samples = float(data["reduced_radius"]), pd.DataFrame(data["samples"])
        title = f"{data['case']}: {law.mode} of {law.shape}"
        samples = samples.astype(dict.fromkeys(_COLUMNS, float))
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{folder / SUMMARY}: is damaged ({error}); {_REMEDY}") from None
    d = np.geomspace(samples["gap"].min(), samples["gap"].max(), 400)
    with saved_figure(output, (8.0, 7.5), theme=theme) as figure:
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1.2, 1.0))
        upper.set(title=plain(title))
        _draw_law(upper, law, samples, d, a)
        _draw_rest(lower, law, samples, d, a)


def _exact(law: LawFile, d: Array, a: float) -> Array | None:
    """The exact resistance at gaps d, None where none is known."""
    if law.shape == "shapes":
        return None
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


def _draw_law(axes: Axes, law: LawFile, samples: pd.DataFrame, d: Array, a: float) -> None:
    """Resistance against the gap."""
    if (exact := _exact(law, d, a)) is not None:
        axes.loglog(d, exact, color=GREY, lw=5, alpha=0.6, label="exact")
    inside = _in_range(law, d, a)
    axes.loglog(inside, law.law().kappa(inside, a), color=BLUE, lw=1.2, label=f"law ({law.form})")
    for held_out, colour, marker, name in _KINDS:
        of = samples[samples["held_out"] == held_out]
        axes.errorbar(of["gap"], of["kappa"], of["error"], fmt=marker, color=colour, mfc="none", label=name)
    axes.set(ylabel="resistance $\\kappa$ = F/U")
    axes.legend()


def _draw_rest(axes: Axes, law: LawFile, samples: pd.DataFrame, d: Array, a: float) -> None:
    """Samples and exact law less the law, relative, with its confidence band."""
    inside = _in_range(law, d, a)
    fitted = law.law().kappa(inside, a)
    if (band := law.error(inside, a)) is not None:
        part = band / fitted
        axes.fill_between(inside, -part, part, color=BLUE, alpha=0.2, lw=0, label="95 % of the law")
    if (exact := _exact(law, inside, a)) is not None:
        axes.plot(inside, exact / fitted - 1.0, color=GREY, lw=3, alpha=0.7, label="exact")
    for held_out, colour, marker, name in _KINDS:
        of = samples[(samples["held_out"] == held_out) & samples["law"].notna()].astype({"law": float})
        rest, bar = of["kappa"] / of["law"] - 1.0, of["error"] / of["law"]
        axes.errorbar(of["gap"], rest, bar, fmt=marker, color=colour, mfc="none", capsize=3, label=name)
    axes.axhline(0.0, color=mpl.rcParams["text.color"], lw=0.6)
    axes.set_xscale("log")
    axes.xaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))  # more would have labels that overlap
    # Linear within the errors of most samples, logarithmic beyond: the band opens up at the last gaps.
    typical = float((samples["error"] / samples["kappa"]).median())
    axes.set_yscale("symlog", linthresh=10.0 ** np.ceil(np.log10(typical)))
    axes.set(xlabel="gap d", ylabel="relative to the law, less 1")
    axes.legend(ncols=5, fontsize=9, loc="lower center", bbox_to_anchor=(0.5, 1.0))  # above all points
