"""Ten gaps in a Python loop: what resists a disc that turns beside a plane?

    python docs/examples/ten_gaps.py [ten_gaps.png]

One case, one key changed: `fsi.load_case(FILE, ["bodies.0.position=..."])` is `--set` of the command line.
The torque of the fluid on a disc that turns at unit rate beside a plane is known in closed form (Jeffrey and
Onishi 1981, QJMAM 34:129): -4 pi mu a^2 / tanh(alpha), cosh(alpha) = 1 + gap / a. Each result comes with an
estimate of its error; the true ones are drawn beside it.
"""

import sys
from pathlib import Path

import numpy as np

import fsi
from fsi.lubrication.exact import rotation_resistance
from fsi.postprocess.plots.figure import BLUE, GREY, ORANGE, saved_figure

CASE = Path(__file__).parents[2] / "cases" / "validation" / "disc_wall_rotation.toml"
GAPS = np.geomspace(1e-3, 1.0, 10)


def torque(gap: float) -> tuple[float, float]:
    """Of the fluid on the disc, mu = a = omega = 1, and its estimated error."""
    solution = fsi.solve(fsi.load_case(CASE, [f"bodies.0.position=[0.0, {1.0 + gap}]"]))
    assert solution.errors is not None
    return float(solution["disc"].torque), float(solution.errors.F[0, 2])


def main(picture: Path) -> None:
    """Loop, print, draw."""
    found, bar = np.array([torque(gap) for gap in GAPS]).T
    exact = -rotation_resistance(GAPS, 1.0, 1.0)
    error = np.abs(found / exact - 1.0)
    for row in zip(GAPS, found, exact, error, bar / np.abs(found), strict=True):
        print("gap {:8.5f}: torque {:11.6f}, exact {:11.6f}, error {:.1e}, estimated {:.1e}".format(*row))
    assert error.max() < 1e-4  # the tolerance of cases/validation
    with saved_figure(picture, (6.5, 6.0)) as figure:
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.0, 1.0])
        upper.loglog(GAPS, -exact, color=GREY, lw=5, alpha=0.5, label="exact")
        upper.loglog(GAPS, -found, "o", color=BLUE, label="resolved")
        upper.set(ylabel="torque against the turn")
        upper.legend()
        lower.loglog(GAPS, error, "o-", color=ORANGE, label="true")
        lower.loglog(GAPS, bar / np.abs(found), "_", color=BLUE, ms=12, label="estimated")
        lower.set(xlabel="gap over radius", ylabel="relative error")
        lower.legend(ncols=2)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "ten_gaps.png"))
