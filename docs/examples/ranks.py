"""The same numbers on one process and on two.

    python docs/examples/ranks.py [ranks.png]

Commands work under `mpiexec`, all but those that start their processes themselves (`fsi sweep --ranks 2`),
and so do Python programs whose ranks all call `fsi` with the same arguments. They give what they give in
serial to 1e-9: take the `mpiexec` beside this Python. Here two ranks solve ten sheared discs, whose apparent
viscosity is 8.29807960 (cases/couette_N10.toml). At such sizes a second rank gains nothing.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from fsi.postprocess.plots.figure import BLUE, ORANGE, saved_figure

CASE = Path(__file__).parents[2] / "cases" / "couette_N10.toml"
EXPECTED = 8.298079598524666  # of that case


def solved(ranks: int) -> dict[str, object]:
    """What `fsi solve CASE --json` prints on so many ranks."""
    command = [sys.executable, "-m", "fsi", "solve", str(CASE), "--json"]
    if ranks > 1:
        command = [str(Path(sys.executable).parent / "mpiexec"), "-n", str(ranks), *command]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    found: dict[str, object] = json.loads(done.stdout)
    return found


def main(picture: Path) -> None:
    """Solve on one and on two ranks, compare, draw what is left of the differences."""
    serial, parallel = solved(1), solved(2)
    velocities = [np.array([body["velocity"] for body in each["bodies"]]) for each in (serial, parallel)]
    apart = np.abs(velocities[1] - velocities[0]).max(axis=1)
    difference = parallel["dissipation"] / serial["dissipation"] - 1.0
    print(f"dissipation {serial['dissipation']:.9f} and {parallel['dissipation']:.9f}: {difference:.0e}")
    print(f"velocities differ by at most {apart.max():.0e}")
    assert abs(difference) < 1e-9
    assert apart.max() < 1e-8
    height, rate = 8.862269, 1.0
    assert abs(serial["dissipation"] / (rate**2 * height**2) / EXPECTED - 1.0) < 1e-5
    with saved_figure(picture, (6.5, 4.0)) as figure:
        axes = figure.add_subplot(xlabel="disc", ylabel="size of the velocity", yscale="log")
        disc = np.arange(1, len(apart) + 1)
        axes.plot(disc, np.linalg.norm(velocities[0], axis=1), "o", color=BLUE, label="on one rank")
        axes.plot(disc, np.maximum(apart, 1e-16), "_", color=ORANGE, ms=12, label="difference on two")
        axes.legend()


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "ranks.png"))
