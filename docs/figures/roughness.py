r"""From which distance on is a rough surface no smooth one? A disc r = 1 + eps cos(n theta) beside others.

    python docs/figures/roughness.py runs/roughness docs/roughness.png

Resolved is the force against the approach of such a disc and a plane, with a crest or a trough between crests
in front, and of two such discs, crest to crest and crest to trough. d is the distance of the mean circles,
and the force of smooth discs there is exact (`fsi.lubrication.named_laws`). Of each pair are printed

    touch       the d at which crests touch
    delta       the d at which the force is 1.1 times the smooth one
    shift       by how much smooth discs with this force at d = 0.3 would be larger
    delta_2     the d at which it is twice the smooth one
    gamma_min   - mu int kappa dd from delta_2 to 1: the memory that is stored by then
    roughness   the gap at which the memory of smooth discs is as large: d less the shift

and drawn the ratio of both forces and the memory over d. Forces that the folder has are taken from there.
"""

import csv
import sys
from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

import fsi
from fsi.bodies.gaps import find_gaps
from fsi.case.case import Case
from fsi.lubrication.named_laws import exact_resistance
from fsi.models import make_model
from fsi.postprocess.plots.figure import BLUE, GREEN, GREY, ORANGE, saved_figure

FAR, LEFT, RIGHT = 200.0, 1.1, 2.0  # the container; ratios of forces at delta and delta_2
WIDE, WIDEST = 0.3, 1.0  # the d of the shift, and from which memory counts
GAPS = np.geomspace(1e-4, WIDEST, 27)
GROWN = 0.1  # more than any shift is


@dataclass(frozen=True)
class Pair:
    """A rough disc in front of a plane or of another.

    Attributes:
        name: what is in front of what.
        eps, n: of r = 1 + eps cos(n theta).
        turned: the angle of the upper disc, in waves: 0 is a crest in front, 1/2 a trough.
        two: whether another such disc is below, a crest in front, and no plane.
    """

    name: str
    eps: float
    n: int
    turned: float
    two: bool = False

    def at(self, d: float) -> Case:
        """At the distance d of the mean circles, with a unit of approach; of two the force is 1."""
        shape = {"kind": "fourier", "radius": 1.0, "orders": [self.n], "cosines": [self.eps]}
        down = {
            "shape": shape,
            "angular_velocity": 0.0,
            "angle": -0.5 * np.pi + 2.0 * np.pi * self.turned / self.n,
        }
        if not self.two:
            bodies = [down | {"name": "rough", "position": [0.0, 1.0 + d], "velocity": [0.0, -1.0]}]
            domain = {"shape": "half-plane", "radius": FAR}
        else:
            y, free = 1.0 + 0.5 * d, {"velocity": [0.0, "free"]}
            up = down | {"angle": 0.5 * np.pi} | free
            bodies = [down | free | {"name": "rough", "position": [0.0, y], "force": [0.0, -1.0]}]
            bodies += [up | {"name": "other", "position": [0.0, -y], "force": [0.0, 1.0]}]
            domain = {"shape": "round", "radius": FAR}
        return fsi.make_case(name=self.name, fluid={"viscosity": 1.0}, domain=domain, bodies=bodies)

    def gap(self, d: float) -> float:
        """Of closest points; negative where surfaces overlap."""
        case = self.at(WIDEST)
        down = np.array([[0.0, d - WIDEST, 0.0], [0.0, 0.0, 0.0]])[: len(case.bodies)]
        return find_gaps(case.configuration().moved(down), case.container(), inf).smallest()

    def force(self, d: float) -> float:
        """Over the speed of approach, resolved."""
        case = self.at(d)
        found = make_model(case)(case.configuration(), 0.0)
        return float(1.0 / (found.U[1, 1] - found.U[0, 1])) if self.two else float(-found.F[0, 1])

    def smooth(self, d: np.ndarray | float) -> np.ndarray:
        """The same of smooth discs, exact."""
        s, ratio = (2.0 * np.asarray(d), 1.0) if self.two else (np.asarray(d), inf)
        return np.asarray(exact_resistance("discs", "squeeze", s, ratio))

    def shift(self, d: float, force: float) -> float:
        """By how much the radii of smooth discs are larger that have this force with the same centres.

        Waves that are many and low let the flow begin at eps^2 n, to second order.
        """
        discs = 2.0 if self.two else 1.0

        def excess(s: float) -> float:
            return float(self.smooth((d - discs * s) / (1.0 + s))) / force - 1.0

        return float(brentq(excess, -GROWN, GROWN, xtol=1e-12))


ROUGH = (
    Pair("crest to plane", 0.02, 20, 0.0),
    Pair("trough to plane", 0.02, 20, 0.5),
    Pair("crest to plane, half as high", 0.01, 20, 0.0),
    Pair("crest to crest", 0.02, 20, 0.0, two=True),
    Pair("crest to trough", 0.02, 20, 0.5, two=True),
)
STYLES = dict(
    zip(ROUGH, ((BLUE, "-"), (BLUE, "--"), (GREY, "-"), (ORANGE, "-"), (ORANGE, "--")), strict=True)
)


def touching(pair: Pair) -> float:
    """The d at which crests touch."""
    return float(brentq(pair.gap, -pair.eps, 3.0 * pair.eps, xtol=1e-12))


def sampled(pair: Pair, folder: Path) -> tuple[float, np.ndarray, np.ndarray]:
    """Where it touches, distances d and forces; computed if the folder has them not."""
    table = folder / f"{pair.name.replace(' ', '_').replace(',', '')}.csv"
    if not table.exists():
        touch = touching(pair)
        distances = np.sort(np.append(touch + GAPS, WIDE)).tolist()
        rows = [(touch, d, pair.force(d)) for d in distances]
        folder.mkdir(parents=True, exist_ok=True)
        with table.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([("touch", "d", "force"), *rows])
    touch, d, force = np.loadtxt(table, delimiter=",", skiprows=1).T
    return float(touch[0]), d, force


def crossing(d: np.ndarray, ratio: np.ndarray, value: float) -> float:
    """The largest d at which the ratio is this value, NaN if at none."""
    places = CubicSpline(np.log(d), np.log(ratio)).solve(np.log(value), extrapolate=False)
    return float(np.exp(places.max())) if len(places) else np.nan


def memory(d: np.ndarray, force: np.ndarray) -> Callable[[float], float]:
    """- int kappa dd from a distance to the widest, by a spline through the logarithms."""
    law = CubicSpline(np.log(d), np.log(force))

    def gamma(x: float) -> float:
        s = np.linspace(np.log(x), np.log(WIDEST), 2001)
        return -float(np.trapezoid(np.exp(law(s) + s), s))

    return gamma


def row(pair: Pair, touch: float, d: np.ndarray, force: np.ndarray) -> str:
    """What is printed of a pair."""
    ratio = force / pair.smooth(d)
    shift = pair.shift(WIDE, float(force[d == WIDE][0]))
    near = np.geomspace(1e-4, WIDEST, 400)
    delta, twice = (crossing(d, ratio, value) for value in (LEFT, RIGHT))
    gamma = memory(d, force)(twice) if np.isfinite(twice) else np.nan
    smooth = memory(near, pair.smooth(near))
    gap = float(brentq(lambda x: smooth(x) - gamma, 1e-4, WIDEST)) if np.isfinite(gamma) else np.nan
    numbers = f"{delta:9.4f} {shift:9.5f} {twice:9.4f} {gamma:11.2f} {gap:11.4f}"
    return f"{pair.name:30s} {touch:8.5f} {numbers}"


def main(folder: Path, picture: Path) -> None:
    """Compute what is not there yet, print the table and draw."""
    print(f"{'':30s}    touch     delta     shift   delta_2   gamma_min   roughness")
    with saved_figure(picture, (9.5, 4.2)) as figure:
        left, right = figure.subplots(1, 2)
        for pair in ROUGH:
            touch, d, force = sampled(pair, folder)
            print(row(pair, touch, d, force), flush=True)
            colour, style = STYLES[pair]
            line = {"color": colour, "ls": style, "marker": ".", "label": pair.name}
            left.plot(d, force / pair.smooth(d), **line)
            gamma = memory(d, force)
            right.plot(d[:-1], [-gamma(x) for x in d[:-1].tolist()], **line)
        near = np.geomspace(2e-3, 0.9, 100)
        for pair, label in ((ROUGH[0], "smooth, plane"), (ROUGH[3], "smooth, two")):
            gamma = memory(np.append(near, WIDEST), pair.smooth(np.append(near, WIDEST)))
            right.plot(near, [-gamma(x) for x in near.tolist()], ":", color=GREEN, label=label)
        for value in (LEFT, RIGHT):
            left.axhline(value, color=GREY, lw=0.8)
        left.set(
            xscale="log", yscale="log", ylim=(0.5, 100.0), xlabel="d / a", ylabel="force over the smooth one"
        )
        right.set(xscale="log", yscale="log", xlabel="d / a", ylabel="memory, - gamma / (mu a)")
        left.legend(fontsize=8)
        right.legend(fontsize=8)


if __name__ == "__main__":
    main(*(Path(word) for word in sys.argv[1:3]))
