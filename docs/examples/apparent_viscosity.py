"""How much do ten discs resist being sheared between two walls, and how fine must the mesh be to know it?

    python docs/examples/apparent_viscosity.py [apparent_viscosity.png]

The channel is periodic; 40 % of it are discs, the narrowest of whose gaps is 0.02 radii wide. For each number
of cells across a gap the shear stress on the walls over that of the pure fluid is printed, beside its
relative difference from 8.29807960, on which spectral boundary integrals and elements of degree 8 agree
(cases/couette_N10.toml). It is also what the mean stress and the dissipation give: their largest
difference is the last column.
"""

import sys
from pathlib import Path

import numpy as np

from fsi.case.load import load_case
from fsi.postprocess.plots.figure import BLUE, ORANGE, saved_figure
from fsi.stokes.model import StokesModel

CASE = Path(__file__).parents[2] / "cases" / "couette_N10.toml"
EXPECTED = 8.298079598524666  # of cases/couette_N10.toml
CELLS = (0.1, 0.3, 1.0)  # across a gap


def viscosity(cells_per_gap: float) -> tuple[int, float, float]:
    """Unknowns, apparent viscosity over that of the fluid, largest difference of the ways to it."""
    # The same as --set discretisation.cells_per_gap=... on the command line.
    case = load_case(CASE, [f"discretisation.cells_per_gap={cells_per_gap}"])
    solution = StokesModel(case)(case.configuration(), t=0.0)
    record = solution.record
    return int(record["dofs"]), float(record["apparent_viscosity"]), float(record["stress"])


def table() -> list[tuple[float, int, float, float]]:
    """Rows of cells per gap, unknowns, apparent viscosity, difference."""
    return [(cells, *viscosity(cells)) for cells in CELLS]


def main(picture: Path) -> None:
    """Print the table, and draw it."""
    rows = table()
    print("cells/gap   unknowns   viscosity   relative error   three ways")
    for cells, dofs, mu, difference in rows:
        print(f"{cells:9g} {dofs:10d} {mu:11.6f} {mu / EXPECTED - 1.0:16.1e} {difference:12.1e}")
    cells, _, mu, ways = np.array(rows).T
    errors = np.abs(mu / EXPECTED - 1.0)
    assert errors[-1] < 1e-6
    with saved_figure(picture, (6.5, 4.0)) as figure:
        axes = figure.add_subplot(xlabel="cells across a gap", ylabel="relative")
        axes.loglog(cells, errors, "o-", color=BLUE, label="error of the viscosity")
        axes.loglog(cells, ways, "s--", color=ORANGE, label="difference of the three ways to it")
        axes.legend()


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "apparent_viscosity.png"))
