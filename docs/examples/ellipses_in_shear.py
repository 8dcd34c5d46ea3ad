"""Do ellipses in a crowd turn as they do alone, and do they stay aligned?

    python docs/examples/ellipses_in_shear.py [ellipses_in_shear.png]

Six ellipses twice as long as wide, area fraction 0.2, stand across the flow in a sheared cell. Alone each
would turn by Jeffery's law (1922), theta' = -(a^2 sin^2 theta + b^2 cos^2 theta) / (a^2 + b^2): fast across
the flow, slowly along it. All would keep one angle, and the order parameter S = |< exp(2 i theta) >| would
stay 1. In the crowd each has its own neighbours: S falls, and they turn at another rate.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import fsi
from fsi.arrays import Array
from fsi.postprocess.plots.figure import BLUE, GREY, ORANGE, saved_figure

RATIO, END = 2.0, 1.2


def jeffery(t: Array) -> Array:
    """The rate of turning of one alone that stands across the flow at t = 0: r tan theta = cot s."""
    r, s = RATIO, RATIO * t / (RATIO**2 + 1.0)
    theta = np.arctan2(np.cos(s), r * np.sin(s))
    rate: Array = -(r**2 * np.sin(theta) ** 2 + np.cos(theta) ** 2) / (r**2 + 1.0)
    return rate


def main(picture: Path) -> None:
    """Shear them, compare the rate of turning with that of one alone, draw both and S."""
    case = fsi.make_case(
        name="ellipses across a shear flow",
        fluid={"viscosity": 1.0},
        domain={"shape": "cell", "shear": 1.0},
        arrangement={
            "kind": "random", "number": 6, "area_fraction": 0.2, "gap": 0.1, "cell": "periodic",
            "shape": "ellipse", "ratio": RATIO, "aligned": 90.0, "seed": 2,
        },
        discretisation={"degree": 2, "cells_per_circle": 20, "growth": 0.6},
        time={"end": END, "scheme": "adams", "tolerance": 1e-2, "remesh": "when-needed"},
        output={"fields": False},
    )  # fmt: skip
    with tempfile.TemporaryDirectory() as name:
        steps = fsi.open_run(fsi.run(case, Path(name) / "run").path).steps
    t, S, rate = (steps[column].to_numpy() for column in ("t", "order_parameter", "tumbling_rate"))
    alone = jeffery(t)
    print(f"at the start they turn at {rate[0]:.3f}, alone at {alone[0]:.3f}; in the end S = {S[-1]:.3f}")
    assert np.abs(rate - alone).max() < 0.1  # held upright they would be 0.3 off in the end
    assert S[0] > 1.0 - 1e-12
    assert S[-1] < 0.99
    with saved_figure(picture, (6.5, 4.0)) as figure:
        axes = figure.add_subplot(xlabel="strain", ylabel="S, rate of turning")
        axes.plot(t, S, color=ORANGE, label="order parameter S")
        axes.plot(t, rate, color=BLUE, label="mean rate of turning")
        axes.plot(t, alone, "--", color=GREY, label="alone")
        axes.legend()


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "ellipses_in_shear.png"))
