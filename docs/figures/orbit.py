"""Jeffery's orbit: a free spheroid in shear, followed over a quarter of its period, against the closed form.

    python docs/figures/orbit.py runs/orbit docs/orbit.png

Printed is how far its axis is at the end from where `fsi.lubrication.ellipsoids.spheroid_axis` has it; drawn
are its components over time. A run that is there already is taken as it is; one takes some four CPU minutes.
"""

import sys
from math import pi
from pathlib import Path

import numpy as np
import scipy  # its modules load when they are used

import fsi
from fsi.lubrication.ellipsoids import spheroid_axis
from fsi.postprocess.plots.figure import BLUE, GREEN, ORANGE, saved_figure

CASE = Path(__file__).parents[2] / "cases" / "shapes" / "ellipsoid_in_shear.toml"
RATIO, ANGLE = 2.0, [0.3, 0.2, 1.0]  # it leaves the plane of shear
END = 0.5 * pi * (RATIO + 1.0 / RATIO)
SHEAR = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])  # u = z e_x


def followed(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) and the axis then, (n, 3)."""
    if not folder.exists():
        changes = [f"bodies.0.shape.axes={[RATIO / 2.0, 0.5, 0.5]}", f"bodies.0.angle={ANGLE}"]
        changes += [f"time.end={END}", "discretisation.cells_per_circle=20", "output.fields=false"]
        fsi.run(fsi.load_case(CASE, changes), folder)
    bodies = fsi.open_run(folder).columns("bodies")
    angles = np.column_stack([bodies[f"angle_{letter}"] for letter in "xyz"])
    return bodies["t"], scipy.spatial.transform.Rotation.from_rotvec(angles).as_matrix()[:, :, 0]


def main(folder: Path, picture: Path) -> None:
    """Run if it is not there yet, print and draw."""
    t, d = followed(folder)
    every = np.linspace(0.0, END, 200)
    there, exact = (
        np.array([spheroid_axis(RATIO, SHEAR, d[0], at) for at in times.tolist()]) for times in (t, every)
    )
    off = np.linalg.norm(d - there, axis=1)[-1]
    print(f"after {t[-1]:.4f} in {len(t) - 1} steps the axis is off by {off:.1e}")
    with saved_figure(picture, (6.0, 3.8)) as figure:
        axes = figure.add_subplot(xlabel="time times rate of shear", ylabel="axis of the spheroid")
        for k, (colour, dash) in enumerate(((BLUE, "-"), (GREEN, "--"), (ORANGE, ":"))):
            axes.plot(every, exact[:, k], dash, color=colour, label="xyz"[k])
            axes.plot(t, d[:, k], "o", color=colour)
        axes.legend()


if __name__ == "__main__":
    main(*(Path(word) for word in sys.argv[1:3]))
