"""A run goes on: to a later end, and after it was broken off.

    python docs/examples/longer_end.py [longer_end.png]

`fsi resume RUN --set time.end=2` takes a finished run further; in serial it then has the same rows as one
that was given that end at first. Here a disc settles by its lubrication alone, and its gap is that of the
exact law (Jeffrey and Onishi 1981), q' = F (alpha - tanh alpha) / (4 pi mu), cosh alpha = 1 + q.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import fsi
from fsi.lubrication.exact import settling_gap
from fsi.postprocess.plots.figure import BLUE, GREY, ORANGE, saved_figure

START, FORCE = 0.5, -10.0


def case(end: float) -> fsi.Case:
    """A disc that falls onto a plane, without a mesh."""
    return fsi.make_case(
        name="settling",
        model="reduced",
        fluid={"viscosity": 1.0},
        domain={"shape": "half-plane", "radius": 1e4},
        bodies=[{"name": "disc", "radius": 1.0, "position": [0.0, 1.0 + START], "force": [0.0, FORCE]}],
        reduced={"law": "exact", "drag": 1e-9},
        time={"end": end, "tolerance": 1e-7},
        output={"interval": 0.5},
    )


def main(picture: Path) -> None:
    """Run to t = 1, on to t = 2, compare with one run and with the exact law."""
    with tempfile.TemporaryDirectory() as name:
        short = fsi.run(case(1.0), Path(name) / "run")
        first = short.end
        longer = fsi.resume(Path(name) / "run", overrides=["time.end=2.0"])
        once = fsi.run(case(2.0), Path(name) / "once")
        t, y = (longer.bodies[column].to_numpy(dtype=float) for column in ("t", "y"))
        changed = longer.launches[-1]["changed"]
        apart = np.abs(y[-1] - once.bodies["y"].to_numpy(dtype=float)[-1])
    exact = settling_gap(t, START, 1.0, 1.0, FORCE)
    error = np.abs((y - 1.0) / exact - 1.0).max()
    print(f"ended at t = {first:g}, went on to {t[-1]:g}; changed: {changed}")
    print(f"gap {y[-1] - 1.0:.9f}, exact {exact[-1]:.9f}; from a run in one piece it differs by {apart:.0e}")
    assert (first, t[-1]) == (1.0, 2.0)
    assert error < 1e-5  # steps have a tolerance of 1e-7
    assert apart < 1e-6
    with saved_figure(picture, (6.5, 4.0)) as figure:
        axes = figure.add_subplot(xlabel="t", ylabel="gap over radius", yscale="log")
        axes.plot(t, exact, color=GREY, lw=6, alpha=0.5, label="exact")
        axes.plot(t[t <= first], y[t <= first] - 1.0, "o-", color=BLUE, ms=4, label="run to t = 1")
        axes.plot(t[t >= first], y[t >= first] - 1.0, "s-", color=ORANGE, ms=4, label="continued")
        axes.legend()


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "longer_end.png"))
