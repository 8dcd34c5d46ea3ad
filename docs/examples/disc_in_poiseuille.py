"""Where does a channel flow carry a disc, and does it cross the channel? Its position over time.

    python docs/examples/disc_in_poiseuille.py [disc_in_poiseuille.png]

A free disc of radius 0.5 in a channel of height 2 that is periodic along x; the fluid, and the disc in it,
carry the flux 4/3 of the flow 1 - y^2. On the centreline it moves at 0.887998643 (Faxen 1946). Off it it
lags, turns, and stays at its height: Stokes flow can be reversed, and the channel mirrored, so that a drift
towards the middle would be one away from it.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import fsi
from fsi.arrays import Array
from fsi.postprocess.plots.figure import BLUE, GREY, ORANGE, saved_figure

CENTRELINE = 0.8879986433855984  # cases/validation/disc_in_poiseuille.toml
HEIGHTS = (0.0, 0.2, 0.35)


def followed(height: float, folder: Path) -> Array:
    """Rows of t, x, y, angle of a disc that begins at that height."""
    case = fsi.make_case(
        name="disc in Poiseuille flow",
        fluid={"viscosity": 1.0},
        domain={"lower": [-4.0, -1.0], "upper": [4.0, 1.0], "periodic": ["x"], "net_flux": 4.0 / 3.0},
        bodies=[{"name": "disc", "radius": 0.5, "position": [0.0, height]}],
        time={"end": 4.0, "tolerance": 1e-4},
        output={"fields": False},
    )
    bodies = fsi.run(case, folder).bodies
    return bodies[["t", "x", "y", "angle"]].to_numpy(dtype=float)


def main(picture: Path) -> None:
    """Follow the discs, print their speeds, draw their positions."""
    with tempfile.TemporaryDirectory() as name, saved_figure(picture, (7.5, 5.0)) as figure:
        along, across = figure.subplots(2, 1, sharex=True)
        for height, colour in zip(HEIGHTS, (GREY, BLUE, ORANGE), strict=True):
            t, x, y, angle = followed(height, Path(name) / str(height)).T
            speed = (x[-1] - x[0]) / t[-1]
            print(f"y = {height:g}: speed {speed:.6f}, rotation {angle[-1] / t[-1]:.6f}")
            assert np.ptp(y) < 1e-4  # of a step's error; a real drift would grow with t
            assert height > 0.0 or abs(speed / CENTRELINE - 1.0) < 1e-4
            along.plot(t, x, color=colour, label=f"begins at y = {height:g}")
            across.plot(t, y, color=colour)
        along.set(ylabel="x")
        along.legend()
        across.set(xlabel="t", ylabel="y", ylim=(-0.5, 0.5))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "disc_in_poiseuille.png"))
