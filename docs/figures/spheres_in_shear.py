"""Two free spheres that pass each other in shear, against the exact way of one past the other.

    python docs/figures/spheres_in_shear.py runs/pair_in_shear docs/spheres_in_shear.png

Printed is how far the second centre less the first is from where `fsi.lubrication.spheres_in_shear` has it. A
run that is there already is taken as it is.
"""

import sys
from pathlib import Path

import numpy as np

import fsi
from fsi.arrays import Array
from fsi.lubrication.spheres_in_shear import relative_path
from fsi.postprocess.plots.figure import BLUE, GREY, ORANGE, saved_figure

CASE = Path(__file__).parents[2] / "cases" / "pair_in_shear.toml"
SHEAR = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])  # u = z e_x


def followed(folder: Path) -> tuple[Array, Array]:
    """Times (n,) and the second centre less the first then, (n, 3)."""
    if not folder.exists():
        fsi.run(fsi.load_case(CASE), folder)
    bodies = fsi.open_run(folder).columns("bodies")
    t, x = bodies["t"][::2], np.column_stack([bodies[letter] for letter in "xyz"])
    return t, x[1::2] - x[::2]


def main(folder: Path, picture: Path) -> None:
    """Run if it is not there yet, print and draw."""
    t, r = followed(folder)
    there = relative_path(r[0].tolist(), 1.0, SHEAR, t)
    off = np.linalg.norm(r - there, axis=1)
    print(f"after {t[-1]:g} in {len(t) - 1} steps off by {off[-1]:.1e} radii, at most {off.max():.1e}")
    every = relative_path(r[0].tolist(), 1.0, SHEAR, np.linspace(0.0, t[-1], 100))
    with saved_figure(picture, (6.0, 3.2)) as figure:
        axes = figure.add_subplot(xlabel="x / a", ylabel="second centre less the first")
        for k, name, colour in ((2, "z / a", BLUE), (1, "y / a", ORANGE)):
            for side in (1.0, -1.0):
                axes.plot(side * every[:, 0], every[:, k], color=colour if side > 0.0 else GREY)
            axes.plot(r[:, 0], r[:, k], "o", color=colour, label=name)
        axes.legend()


if __name__ == "__main__":
    main(*(Path(word) for word in sys.argv[1:3]))
