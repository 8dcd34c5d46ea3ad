"""From resolved forces to a law, and from the law to a motion that no mesh is made for.

    python docs/examples/calibrated_settling.py [calibrated_settling.png]

Eight meshes give the resistance kappa(d) of a disc beside a plane at gaps d from 0.01 to 1 radii; a series is
fitted to it. The reduced model then lets the disc settle, F = kappa(d) V, from d = 0.9 to below 0.02. The
gap is printed beside that of the exact resistance (Jeffrey and Onishi 1981): what differs is the fit.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

from fsi import open_run
from fsi.arrays import Array
from fsi.calibration.calibrate import LAW, calibrate_case
from fsi.calibration.sampling import Sampling
from fsi.case.load import load_case, parse_case
from fsi.postprocess.analysis.settling import exact_gap
from fsi.postprocess.plots.figure import BLUE, GREY, saved_figure
from fsi.runs import run

CALIBRATION = Path(__file__).parents[2] / "cases" / "calibration" / "disc_wall.toml"
COARSE = ["calibration.range=[0.01, 1.0]", "calibration.samples=8", "calibration.held_out=0"]


def calibrated(folder: Path) -> Path:
    """The file of the law; the same as `fsi calibrate cases/calibration/disc_wall.toml --set ...`."""
    case = load_case(CALIBRATION, COARSE)
    calibrate_case(case, CALIBRATION.name, folder / "law", Sampling(folder / "samples"))
    return folder / "law" / LAW


def settled(law: Path, folder: Path) -> Array:
    """Rows of time, gap, exact gap."""
    case = parse_case(
        {
            "name": "settling by a law",
            "model": "reduced",
            "fluid": {"viscosity": 1.0},
            "domain": {"shape": "half-plane", "radius": 1e4},
            "bodies": [{"name": "disc", "radius": 1.0, "position": [0.0, 1.9], "force": [0.0, -10.0]}],
            "reduced": {"law": str(law), "drag": 1e-6},  # all resistance is that of the gap
            "time": {"end": 20.0, "tolerance": 1e-6},
        }
    )
    run(case, folder / "run")
    bodies = open_run(folder / "run").bodies
    t, gap = bodies["t"].to_numpy(), bodies["y"].to_numpy() - 1.0
    return np.column_stack([t, gap, exact_gap(case, t)])


def table() -> Array:
    """Calibrate, let settle."""
    with tempfile.TemporaryDirectory() as name:
        return settled(calibrated(Path(name)), Path(name))


def main(picture: Path) -> None:
    """Print ten rows of the table, and draw it."""
    rows = table()
    print("        t         gap   exact gap   relative difference")
    for t, gap, exact in rows[np.linspace(0, len(rows) - 1, 10).astype(int)]:
        print(f"{t:9.4g} {gap:11.6f} {exact:11.6f} {gap / exact - 1.0:21.1e}")
    t, gap, exact = rows.T
    assert np.abs(gap / exact - 1.0).max() < 5e-3
    with saved_figure(picture, (6.5, 4.0)) as figure:
        axes = figure.add_subplot(xlabel="t", ylabel="gap over radius", yscale="log")
        axes.plot(t, exact, color=GREY, lw=6, alpha=0.5, label="exact")
        axes.plot(t, gap, color=BLUE, label="by the calibrated law")
        axes.legend()


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "calibrated_settling.png"))
