"""How much more viscous is a dilute suspension of discs? Einstein's law in the plane.

    python docs/examples/dilute_viscosity.py [dilute_viscosity.png]

Free discs in a square cell that is sheared: the apparent viscosity over that of the fluid is 1 + 2 phi +
... at a small area fraction phi (Brady 1984, Int. J. Multiphase Flow 10:113; in space Einstein's 1 + 5/2
phi), and at least 1 / (1 - phi). Pores give an upper bound of it in a fraction of a second, without a mesh.
"""

import sys
from pathlib import Path

import numpy as np

import fsi
from fsi.postprocess.plots.figure import BLUE, GREY, ORANGE, saved_figure

FRACTIONS = np.array([0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.5])


def viscosity(phi: float) -> float:
    """Of a square array of area fraction phi, sheared along one of its axes."""
    side = float(np.sqrt(np.pi / phi))
    case = fsi.make_case(
        name="square array in shear",
        model="pores",
        fluid={"viscosity": 1.0},
        domain={"shape": "cell", "vectors": [[side, 0.0], [0.0, side]], "shear": 1.0},
        bodies=[{"name": "disc", "radius": 1.0, "position": [0.5 * side, 0.5 * side]}],
        pores={"modes": 6},
    )
    found = fsi.solve(case).apparent_viscosity
    assert found is not None
    return found


def main(picture: Path) -> None:
    """Compute, compare the slope at phi = 0, draw."""
    mu = np.array([viscosity(phi) for phi in FRACTIONS])
    slope = (mu - 1.0) / FRACTIONS
    # The next terms are of order phi and phi^2: at 0 the parabola through the first three slopes.
    at_zero = np.polyfit(FRACTIONS[:3], slope[:3], 2)[-1]
    for row in zip(FRACTIONS, mu, slope, strict=True):
        print("phi {:5.2f}: viscosity {:.6f}, (mu - 1) / phi {:.4f}".format(*row))
    print(f"at phi = 0: {at_zero:.4f}, by theory 2")
    assert abs(at_zero - 2.0) < 0.01
    assert np.all(mu >= 1.0 / (1.0 - FRACTIONS))
    with saved_figure(picture, (6.5, 4.5)) as figure:
        axes = figure.add_subplot(xlabel="area fraction", ylabel="apparent viscosity")
        phi = np.linspace(0.0, 0.5, 100)
        axes.plot(phi, 1.0 + 2.0 * phi, color=GREY, lw=4, alpha=0.6, label="1 + 2 phi")
        axes.plot(phi, 1.0 / (1.0 - phi), "--", color=ORANGE, label="1 / (1 - phi), a lower bound")
        axes.plot(FRACTIONS, mu, "o", color=BLUE, label="square array")
        axes.legend()


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "dilute_viscosity.png"))
