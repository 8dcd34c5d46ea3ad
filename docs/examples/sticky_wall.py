"""A disc is pushed onto a wall and pulled off: in a fluid of vanishing viscosity it sticks.

    python docs/examples/sticky_wall.py [sticky_wall.png]

As the viscosity vanishes, lubrication becomes a memory gamma: q' + gamma = u_0 + int f, q >= 0, gamma <= 0,
q gamma = 0 (Lefebvre, Maury 2005). A disc at a gap of 1 is pushed by -2 until t = 1.5 and then pulled by 2.
It arrives at t = 1 with the speed -2, stores that and the push until 1.5, gamma = -3, and comes off at t =
3, when the pull has paid for it; then q = (t - 3)^2.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import fsi
from fsi.postprocess.plots.figure import BLUE, GREY, ORANGE, saved_figure

CASE = Path(__file__).parents[2] / "cases" / "gluey" / "pushed_then_pulled.toml"


def exact(t: np.ndarray) -> np.ndarray:
    """The gap at times t."""
    return np.where(t < 1.0, 1.0 - t**2, np.where(t < 3.0, 0.0, (t - 3.0) ** 2))


def main(picture: Path) -> None:
    """Run with two steps, compare with the exact gap, draw gap and memory."""
    errors = []
    with tempfile.TemporaryDirectory() as name:
        for step in (0.02, 0.01):
            case = fsi.load_case(CASE, [f"time.step={step}", "output.fields=false"])
            run = fsi.run(case, Path(name) / str(step))
            t = run.bodies["t"].to_numpy(dtype=float)
            gap = run.bodies["y"].to_numpy(dtype=float) - 1.0
            memory = run.steps["smallest_gamma"].to_numpy(dtype=float)
            errors.append(float(np.abs(gap - exact(t)).max()))
    print(f"largest errors of the gap {errors[0]:.4f} and {errors[1]:.4f} with steps of 0.02 and 0.01")
    print(f"largest memory {memory.min():.4f}, exactly -3")
    assert 1.8 < errors[0] / errors[1] < 2.2  # the scheme is of first order
    assert errors[1] < 0.03
    assert abs(memory.min() + 3.0) < 0.03
    with saved_figure(picture, (6.5, 5.0)) as figure:
        upper, lower = figure.subplots(2, 1, sharex=True)
        upper.plot(t, exact(t), color=GREY, lw=6, alpha=0.5, label="exact")
        upper.plot(t, gap, color=BLUE, label="computed")
        upper.set(ylabel="gap q")
        upper.legend()
        lower.plot(run.steps["t"], memory, color=ORANGE)
        lower.set(xlabel="t", ylabel="memory gamma")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "sticky_wall.png"))
