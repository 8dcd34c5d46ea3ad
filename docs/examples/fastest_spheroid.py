"""Which spheroid of a given volume falls fastest along its axis? Drags over the ratio of the axes.

    python docs/examples/fastest_spheroid.py [fastest_spheroid.png]

Slender bodies have a small front but a long side. Oberbeck (1876) has the drag of spheroids by integrals;
bodies of revolution are computed as any other profile is. Over the drag of the sphere of the same volume it
is least, 0.9555, where the body is 1.95 times as long as it is wide: it need not be round to fall fast, but
not much is gained.
"""

import sys
from pathlib import Path

import numpy as np
import scipy  # its modules load when they are used

import fsi
from fsi.lubrication.ellipsoids import in_far_ball, translation_resistance
from fsi.postprocess.plots.figure import BLUE, GREY, saved_figure

RADIUS = 1e4  # of the container, which stands for infinity
RATIOS = (0.2, 0.5, 1.0, 1.95, 5.0)  # length over width
FINE = {"degree": 4, "cells_per_circle": 48, "growth": 0.2}


def half_axes(ratio: float) -> list[float]:
    """Across the axis and along it, of a spheroid of the volume of the unit sphere."""
    return [ratio ** (-1.0 / 3.0), ratio ** (2.0 / 3.0)]


def exact(ratio: float) -> float:
    """The drag in unbounded fluid over that of the sphere."""
    a, b = half_axes(ratio)
    return float(translation_resistance(np.array([a, a, b]), 1.0)[2]) / (6.0 * np.pi)


def computed(ratio: float) -> float:
    """The drag in the container over that of the sphere in unbounded fluid."""
    shape = {"kind": "ellipse", "axes": half_axes(ratio)}
    body = {"name": "spheroid", "shape": shape, "position": [0.0, 0.0], "velocity": [0.0, 1.0]}
    case = fsi.make_case(
        name="spheroid",
        geometry="axisymmetric",
        fluid={"viscosity": 1.0},
        domain={"shape": "round", "radius": RADIUS},
        bodies=[body],
        discretisation=FINE,
    )
    return -float(fsi.solve(case)["spheroid"].force[1]) / (6.0 * np.pi)


def main(picture: Path) -> None:
    """Compute the drags, compare, find the least, draw."""
    drags = np.array([computed(ratio) for ratio in RATIOS])
    sphere = 6.0 * np.pi
    far = np.array([in_far_ball(sphere * exact(ratio), RADIUS, 1.0) / sphere for ratio in RATIOS])
    print("ratio and drag:", ", ".join(f"{r:g} {d:.6f}" for r, d in zip(RATIOS, drags, strict=True)))
    np.testing.assert_allclose(drags, far, rtol=1e-5)
    least = scipy.optimize.minimize_scalar(exact, bounds=(1.0, 5.0), method="bounded")
    print(f"least drag {least.fun:.6f} at the ratio {least.x:.4f}")
    assert abs(least.x - 1.95) < 0.01
    assert drags[3] < min(drags[[0, 1, 2, 4]])
    with saved_figure(picture, (6.5, 4.0)) as figure:
        axes = figure.add_subplot(xlabel="length over width", ylabel="drag over that of the sphere")
        ratios = np.geomspace(0.15, 7.0, 200)
        axes.semilogx(ratios, [exact(ratio) for ratio in ratios], color=GREY, label="Oberbeck 1876")
        axes.semilogx(RATIOS, drags, "o", color=BLUE, label="computed")
        axes.set_xticks([0.2, 0.5, 1.0, 2.0, 5.0], ["0.2", "0.5", "1", "2", "5"])
        axes.minorticks_off()
        axes.legend()


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "fastest_spheroid.png"))
