"""What keeps a disc off a plane? The pressure in the film between them, against Reynolds' equation.

    python docs/examples/film_pressure.py [film_pressure.png]

A disc of radius 1 comes down at unit speed, its gap is 0.001. With the film h = gap + x^2 / 2 Reynolds'
equation p_x = -12 mu x / h^3 gives p = 6 mu / h^2 above the pressure far away; its errors are of the order
of the gap. The film is resolved by curved cells; pressures are read at points on its middle.
"""

import sys
from pathlib import Path

import numpy as np

import fsi
from fsi.postprocess.plots.figure import BLUE, GREY, saved_figure

GAP = 1e-3


def main(picture: Path) -> None:
    """Solve, read the pressure along the film, compare, draw."""
    case = fsi.make_case(
        name="film",
        fluid={"viscosity": 1.0},
        domain={"shape": "half-plane", "radius": 100.0},
        bodies=[
            {
                "name": "disc",
                "radius": 1.0,
                "position": [0.0, 1.0 + GAP],
                "velocity": [0.0, -1.0],
                "angular_velocity": 0.0,
            }
        ],
    )
    solution = fsi.solve(case)
    x = np.linspace(-0.2, 0.2, 81)
    h = GAP + 1.0 - np.sqrt(1.0 - x**2)
    _, p = solution.evaluate(np.column_stack([x, 0.5 * h]))
    p = p - p[0] + 6.0 / h[0] ** 2  # its constant is free: both agree at the end of the film
    reynolds = 6.0 / (GAP + 0.5 * x**2) ** 2
    error = np.abs(p - reynolds).max() / reynolds.max()
    print(f"largest pressure {p.max():.1f}, by Reynolds {reynolds.max():.1f}; they differ by {error:.1e}")
    assert error < 5e-3  # the gap times a number of order one
    with saved_figure(picture, (6.5, 4.5)) as figure:
        axes = figure.add_subplot(xlabel="x over radius", ylabel="pressure, mu = U = 1", yscale="log")
        axes.plot(x, reynolds, color=GREY, lw=6, alpha=0.5, label="Reynolds: 6 / h^2")
        axes.plot(x, p, ".", color=BLUE, label="resolved")
        axes.legend()


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "film_pressure.png"))
