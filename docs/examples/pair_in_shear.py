"""How do two discs pass each other in a shear flow that nothing bounds? The path of one as the other sees it.

    python docs/examples/pair_in_shear.py [pair_in_shear.png]

Two free discs of radius 1 in u = y e_x; the fluid ends so far away, at 200 radii, that its end has no effect
to 1e-4. One comes from the left and above, climbs over the other within a thin film, and leaves as it came:
Stokes flow can be reversed, so the path is the same from the right as from the left. What breaks that in
experiments is roughness, or a force between the discs.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import fsi
from fsi.arrays import Array
from fsi.postprocess.plots.figure import BLUE, GREY, saved_figure
from fsi.postprocess.plots.trajectories import relative_path

START, OFFSET, END = -4.0, 0.8, 10.0


def relative(folder: Path) -> Array:
    """The second centre less the first at all steps, (steps, 2); `fsi plot RUN --relative second,first`."""
    half = 0.5 * np.array([START, OFFSET])
    case = fsi.make_case(
        name="pair in shear",
        fluid={"viscosity": 1.0},
        domain={"shape": "round", "radius": 200.0, "walls": {"far": {"shear": 1.0}}},
        bodies=[
            {"name": "first", "radius": 1.0, "position": (-half).tolist()},
            {"name": "second", "radius": 1.0, "position": half.tolist()},
        ],
        discretisation={"degree": 3, "cells_per_circle": 24, "growth": 0.3},
        time={"end": END, "tolerance": 3e-4},
        output={"fields": False},
    )
    return relative_path(fsi.run(case, folder), "second,first")


def main(picture: Path) -> None:
    """Follow the pair, compare both halves of the path, draw it."""
    with tempfile.TemporaryDirectory() as name:
        x, y = relative(Path(name) / "run").T
    gap = np.hypot(x, y).min() - 2.0
    back = np.interp(-x[x < 0.0], x, y)  # the height on the way out, where it was on the way in
    apart = np.abs(back - y[x < 0.0]).max()
    print(f"smallest gap {gap:.4f}; heights in and out differ by at most {apart:.1e}")
    assert x[-1] > -START
    assert apart < 5e-3  # straight lines between steps; a rough pair loses 0.1
    with saved_figure(picture, (8.0, 4.0)) as figure:
        axes = figure.add_subplot(aspect="equal", xlabel="x", ylabel="y")
        turn = np.linspace(0.0, np.pi, 100)
        axes.fill(2.0 * np.cos(turn), 2.0 * np.sin(turn), color=GREY, alpha=0.4, lw=0, label="surfaces meet")
        axes.plot(x, y, ".-", color=BLUE, ms=4, label="centre of the second disc, seen from the first")
        axes.set_ylim(-1.2, 2.6)
        axes.legend(loc="lower center")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "pair_in_shear.png"))
