"""Four arrangements of twenty discs, one area fraction, four apparent viscosities: 1.62, 2.00, 2.45 and 6.54.

    python docs/examples/four_viscosities.py [four_viscosities.png]

The slides "Direct simulation of dense suspensions" show four sheared cells with the apparent viscosities 2.0,
2.45, 1.62 and 6.54, after Lefebvre and Maury, C. R. Mecanique 333 (2005), "Apparent viscosity of a mixture of
a Newtonian fluid and interacting particles". Where their discs stood is lost. At the area fraction 0.3351,
with gaps of 0.02 radii, all four values are there: in rows along the flow, in oblique pairs, at random, and
in columns from wall to wall, which carry the shear like struts. The viscosities are the slides'; the
arrangements are ours, found by `fsi search` as each case says.
"""

import sys
from pathlib import Path

import numpy as np

import fsi
from fsi.postprocess.plots.figure import GREY, saved_figure

CASES = Path(__file__).parents[2] / "cases" / "slides"
SLIDES = {"rows": 1.62, "pairs": 2.0, "random": 2.45, "columns": 6.54}
PIXEL = 0.1
LIGHT = ("discretisation.cells_per_circle=24", "discretisation.growth=0.3")  # errs by less than 1e-4


def solutions(*overrides: str) -> dict[str, fsi.Solution]:
    """Each case at time 0, with changes."""
    return {name: fsi.solve(fsi.load_case(CASES / f"{name}.toml", overrides)) for name in SLIDES}


def draw(found: dict[str, fsi.Solution], path: Path) -> None:
    """The speed of each flow less the mean shear, over the rate of shear times the radius, and the discs.

    Colours go by the root of the speed: that between the columns is several times that between the rows.
    """
    from matplotlib.colors import PowerNorm

    widths = [solution.case.domain.upper[0] for solution in found.values()]
    flows = {name: disturbance(solution) for name, solution in found.items()}
    scale = PowerNorm(0.5, 0.0, max(float(np.nanmax(speed)) for _, _, speed in flows.values()))
    with saved_figure(path, (8.2, 5.7)) as figure:
        panels = figure.subplots(1, len(found), width_ratios=widths)
        for axes, (name, solution) in zip(panels, found.items(), strict=True):
            length, height = solution.case.domain.upper
            drawn = axes.pcolormesh(*flows[name], norm=scale, rasterized=True)
            discs(axes, solution)
            axes.set(aspect="equal", anchor="S", xticks=[], yticks=[], xlim=(0.0, length), ylim=(0.0, height))
            axes.set_title(f"{name}\n{solution.apparent_viscosity:.2f}")
        label = "velocity less the shear, over rate times radius"
        figure.colorbar(drawn, ax=panels, label=label, location="bottom", shrink=0.6, aspect=40)


def disturbance(solution: fsi.Solution) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """X, Y, and there the speed less the mean shear, NaN in discs."""
    length, height = solution.case.domain.upper
    X, Y = np.meshgrid(np.arange(0.0, length, PIXEL), np.arange(0.0, height, PIXEL))
    u = solution.velocity(np.column_stack([X.ravel(), Y.ravel()])).reshape(*X.shape, 2)
    return X, Y, np.hypot(u[..., 0] - Y / height, u[..., 1]) * height


def discs(axes: object, solution: fsi.Solution) -> None:
    """All discs, and their images across the periodic sides."""
    from matplotlib.patches import Circle

    length = solution.case.domain.upper[0]
    for body in solution:
        for shift in (-length, 0.0, length):
            place = (body.position[0] + shift, body.position[1])
            axes.add_patch(Circle(place, 1.0, facecolor="white", edgecolor=GREY, lw=1.0))


def main(path: Path) -> None:
    """Print the viscosities beside those of the slides, and draw the flows."""
    found = solutions(*LIGHT)
    for name, solution in found.items():
        print(f"{name:8} {solution.apparent_viscosity:.4f}, slides {SLIDES[name]}")
        assert abs(solution.apparent_viscosity - SLIDES[name]) <= 5e-3
    draw(found, path)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "four_viscosities.png"))
