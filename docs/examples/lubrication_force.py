"""How large is the lubrication force on a disc that moves towards a plane, and what of it is leading order?

    python docs/examples/lubrication_force.py [lubrication_force.png]

The film is resolved down to a gap of 1e-4 radii. For every gap q the force over its leading term,
`3 sqrt2 pi mu U (a/q)^(3/2)`, is printed beside the same ratio of the exact solution (Jeffrey and Onishi
1981). The leading term alone is 10.5 % off at q/a = 0.1; resolved and exact force agree to 1e-5.
"""

import sys
from pathlib import Path

import numpy as np

from fsi.arrays import Array
from fsi.case.load import load_case
from fsi.lubrication.exact import normal_resistance, plane_lubrication
from fsi.postprocess.plots.figure import BLUE, GREY, saved_figure
from fsi.stokes.model import StokesModel

ROOT = Path(__file__).parents[2]
GAPS = np.array([1.0, 0.1, 0.01, 0.001, 0.0001])


def resolved_force(gap: float) -> float:
    """Force of the fluid on the disc, mu = a = U = 1, from a mesh of its own."""
    # The same as --set bodies.0.position=... on the command line.
    case = load_case(
        ROOT / "cases" / "validation" / "disc_wall_normal.toml", [f"bodies.0.position=[0.0, {1.0 + gap}]"]
    )
    solution = StokesModel(case)(case.configuration(), t=0.0)
    return float(-solution.F[0, 1])  # F is the external load; the fluid exerts the opposite


def table() -> Array:
    """Rows of gap, resolved force, exact force, leading term, shape (5, 4)."""
    resolved = np.array([resolved_force(gap) for gap in GAPS])
    return np.column_stack(
        [GAPS, resolved, normal_resistance(GAPS, 1.0, 1.0), plane_lubrication(GAPS, 1.0, 1.0)]
    )


def main(picture: Path) -> None:
    """Print the table, and draw it."""
    rows = table()
    print("   q/a        force     force/leading   exact/leading   relative error")
    for gap, resolved, exact, leading in rows:
        print(
            f"{gap:6g} {resolved:12.5g} {resolved / leading:14.6f} {exact / leading:15.6f}"
            f" {resolved / exact - 1.0:14.1e}"
        )
    gap, resolved, exact, leading = rows.T
    fine = np.geomspace(GAPS.min(), GAPS.max(), 100)
    assert np.abs(resolved / exact - 1.0).max() < 1e-5
    with saved_figure(picture, (6.5, 4.0)) as figure:
        axes = figure.add_subplot(xlabel="gap over radius", ylabel="force over its leading term")
        exact_ratio = normal_resistance(fine, 1.0, 1.0) / plane_lubrication(fine, 1.0, 1.0)
        axes.semilogx(fine, exact_ratio, color=GREY, lw=6, alpha=0.5, label="exact")
        axes.semilogx(gap, resolved / leading, "o", color=BLUE, label="resolved")
        axes.axhline(1.0, color=GREY, ls=":", label="leading term")
        axes.legend()


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "lubrication_force.png"))
