"""Two blocks of rods collide, stick, and remember: the macroscopic model.

    python docs/examples/colliding_blocks.py [colliding_blocks.png]

rho_t + (rho u)_x = 0, (rho u)_t + (rho u^2 + p)_x = rho f, gamma_t + (gamma u)_x = -p with gamma <= 0, rho
<= 1 and gamma (1 - rho) = 0. Blocks of density 1 on [-2, -1] at u = 1 and on [1, 2] at u = -1/2 meet at t =
4/3 and go on at u = 1/4, as momentum says; the largest memory is the impulse that each block got, 3/4.
Pulled apart by +-1 from t = 2 on they part at t = 2.75, when that is paid back.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import fsi
from fsi.postprocess.plots.trajectories import plot_space_time

CASE = Path(__file__).parents[2] / "cases" / "macroscopic" / "blocks.toml"
CHANGES = ["macroscopic.parcels=200", "time.step=0.01", "output.interval=0.05"]


def main(picture: Path) -> None:
    """Run, compare the three numbers, draw density, velocity and memory over x and t."""
    with tempfile.TemporaryDirectory() as name:
        run = fsi.run(fsi.load_case(CASE, CHANGES), Path(name) / "run")
        plot_space_time(run, picture)
        profiles, steps = run.table("profiles"), run.steps
    together = profiles[np.isclose(profiles["t"], 1.8)]
    memory = float(steps["smallest_gamma"].min())
    holding = steps["t"][steps["smallest_gamma"] < -1e-6]
    print(f"together they move at {together['u'].mean():.6f}, exactly 0.25")
    print(f"largest memory {memory:.4f}, exactly -0.75")
    print(f"they stick from t = {holding.min():.3f} to {holding.max():.3f}, exactly 1.333 to 2.75")
    assert np.abs(together["u"] - 0.25).max() < 1e-9  # momentum is kept to rounding
    assert abs(memory + 0.75) < 0.01  # a parcel's mass is 0.01
    assert abs(holding.min() - 4.0 / 3.0) < 0.02  # two steps
    assert abs(holding.max() - 2.75) < 0.02


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "colliding_blocks.png"))
