r"""How much more than the fluid does a suspension of discs resist, by its area fraction?

    fsi sweep cases/suspensions/fractions.toml --quantity "apparent viscosity" --seeds 10 \
        --vary arrangement.area_fraction=0.1,0.2,0.3,0.4,0.5,0.6,0.7
    fsi sweep cases/suspensions/fractions.toml --quantity "apparent viscosity" --seeds 1 \
        --vary arrangement.area_fraction=0.1,0.2,0.3,0.4,0.5,0.6,0.7 --set model=resolved -o runs/resolved
    python docs/figures/viscosity_over_fraction.py runs/sweep/fractions runs/resolved fractions.png

Draws the mean over arrangements of pore elements, all of them as dots, and the resolved flow of one
arrangement of each area fraction, beside three formulas in which no number is fitted:

- dilute, 1 + 2 phi: what A. Einstein did for spheres, in the plane (J. F. Brady, Int. J. Multiphase Flow 10
  (1984) 113);
- (1 - phi / phi_m)^(-2 phi_m), I. M. Krieger and T. J. Dougherty, Trans. Soc. Rheol. 3 (1959) 137, with that
  intrinsic viscosity 2 and random close packing of discs, phi_m = 0.82 (J. G. Berryman, Phys. Rev. A 27
  (1983) 1053);
- no suspension resists less than 1 / (1 - phi), by the inequality of Cauchy and Schwarz.

The arrangements are those of an equilibrium fluid of hard discs with gaps of at least 0.02 radii, at one
instant; one that has been sheared for long has others.
"""

import csv
import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from fsi.postprocess.plots.figure import BLUE, GREEN, GREY, ORANGE, saved_figure

FRACTION, QUANTITY = "arrangement.area_fraction", "apparent viscosity"
CLOSE_PACKING = 0.82


def column(table: Path, name: str) -> np.ndarray:
    """The numbers of a column of a table of `fsi sweep`; NaN where it is empty."""
    with table.open(encoding="utf-8", newline="") as file:
        return np.array([float(row[name] or "nan") for row in csv.DictReader(file)])


def krieger_dougherty(phi: np.ndarray) -> np.ndarray:
    """With the exact intrinsic viscosity of discs."""
    return (1.0 - phi / CLOSE_PACKING) ** (-2.0 * CLOSE_PACKING)


def draw(pores: Path, resolved: Path, path: Path) -> None:
    """Both sweeps and the formulas, logarithmic."""
    with saved_figure(path, (7.0, 5.0)) as figure:
        axes = figure.subplots()
        draw_formulas(axes)
        runs = pores / "runs.csv"
        axes.plot(column(runs, FRACTION), column(runs, QUANTITY), ".", color=BLUE, alpha=0.25, ms=5)
        means = pores / "sweep.csv"
        phi, mean, bar = (column(means, name) for name in (FRACTION, "mean", "standard_error"))
        axes.errorbar(phi, mean, bar, fmt="o", color=BLUE, capsize=3, label="pores, mean over arrangements")
        runs = resolved / "runs.csv"
        label = "resolved, the first arrangement"
        axes.plot(column(runs, FRACTION), column(runs, QUANTITY), "x", color="black", ms=9, label=label)
        axes.set(yscale="log", xlabel="area fraction", ylabel="apparent viscosity over that of the fluid")
        axes.legend()


def draw_formulas(axes: Axes) -> None:
    """Over area fractions up to 0.75."""
    phi = np.linspace(0.0, 0.75, 300)
    axes.plot(phi, 1.0 / (1.0 - phi), color=GREY, lw=1.0, label="least, 1 / (1 - phi)")
    axes.plot(phi, 1.0 + 2.0 * phi, "--", color=ORANGE, label="dilute, 1 + 2 phi")
    axes.plot(phi, krieger_dougherty(phi), "-.", color=GREEN, label="Krieger and Dougherty, phi_m = 0.82")


def main(pores: Path, resolved: Path, path: Path) -> None:
    """Print the means beside the formulas, and draw them."""
    means = pores / "sweep.csv"
    numbers = [column(means, name) for name in (FRACTION, "mean", "standard_error")]
    print("   phi     pores       ±   1 + 2 phi   Krieger and Dougherty")
    for phi, mean, bar in zip(*numbers, strict=True):
        print(f"{phi:6g} {mean:9.4f} {bar:7.2g} {1 + 2 * phi:11.2f} {krieger_dougherty(phi):15.3f}")
    draw(pores, resolved, path)


if __name__ == "__main__":
    main(*(Path(word) for word in sys.argv[1:4]))
