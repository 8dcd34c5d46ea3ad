"""Two hundred discs sink in a cell that repeats for ever, by a law that resolved forces have calibrated.

    python docs/examples/crowd_by_a_law.py [crowd_by_a_law.png]

`fsi calibrate cases/calibration/equal_discs.toml` has fitted kappa(d), the resistance of two equal discs at a
gap d, to resolved forces; cases/laws/equal_discs.toml holds it. The reduced model moves any number of discs
by it, without a mesh: `sum of all pairs' kappa(d) d' = F - drag V`. Forces of pairs cancel, so without walls
the mean velocity is F / drag, whatever the discs do to each other.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.patches import Circle

import fsi
from fsi.postprocess.plots.figure import BLUE, GREY, ORANGE, saved_figure

LAW = Path(__file__).parents[2] / "cases" / "laws" / "equal_discs.toml"
N, WEIGHT, DRAG, SIDE = 200, 2.0, 4.0, 36.0
HEAVY = np.arange(N) % 3 == 0


def case() -> fsi.Case:
    """Every third disc is four times as heavy as the others."""
    return fsi.make_case(
        name="a crowd under gravity",
        model="reduced",
        fluid={"viscosity": 1.0},
        domain={"shape": "cell", "vectors": [[SIDE, 0.0], [0.0, SIDE]]},
        bodies=[
            {
                "name": f"disc {k}",
                "radius": 1.0,
                "position": [
                    1.2 + 2.5 * (k % 14) + 0.2 * np.sin(k),
                    1.2 + 2.4 * (k // 14) + 0.12 * np.cos(3 * k),
                ],
                "force": [0.0, -WEIGHT * (4.0 if HEAVY[k] else 1.0)],
            }
            for k in range(N)
        ],
        reduced={"law": str(LAW), "drag": DRAG, "cutoff": 1.0},
        time={"end": 3.0, "tolerance": 1e-3},
        output={"interval": 3.0},
    )


def main(picture: Path) -> None:
    """Run, compare the mean velocity, draw the discs with their velocities."""
    with tempfile.TemporaryDirectory() as name:
        run = fsi.run(case(), Path(name) / "run")
        bodies, smallest = run.bodies, run.steps["smallest_gap"].min()
    mean = bodies.groupby("step")["V_y"].mean()
    expected = -WEIGHT * np.where(HEAVY, 4.0, 1.0).mean() / DRAG
    print(f"mean velocity {mean.iloc[-1]:.12f}, weight over drag {expected}; smallest gap {smallest:.4f}")
    assert np.abs(mean / expected - 1.0).max() < 1e-9  # a pair's force that did not cancel would show
    assert smallest > 0.0
    last = bodies[bodies["step"] == bodies["step"].max()]
    with saved_figure(picture, (6.5, 6.5)) as figure:
        axes = figure.add_subplot(aspect="equal", xlabel="x", ylabel="y")
        for chosen, colour, label in ((HEAVY, ORANGE, "heavy"), (~HEAVY, BLUE, "light")):
            of = last[chosen]
            style = {"color": colour, "scale": 40.0, "label": label, "zorder": 2}
            axes.quiver(of["x"], of["y"], of["V_x"], of["V_y"], **style)
        for x, y in last[["x", "y"]].to_numpy(dtype=float):
            axes.add_patch(Circle((x, y), 1.0, fill=False, color=GREY, lw=0.8))
        axes.legend(loc="upper right")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "crowd_by_a_law.png"))
