"""Errors and bars of the force on a disc in a box under a sliding lid, and below an open wall.

    python bench/corners.py

Both make the data of walls jump at two corners. For each degree and size of cells it prints the largest error
of force and torque against degree 4 on a mesh 1.5 times as fine as the finest, its order, and the bar over
that error.
"""

from itertools import pairwise
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.stokes.adapt import solve_with_errors
from fsi.stokes.model import StokesModel

WALLS: dict[str, Any] = {"sliding lid": [1.0, 0.0], "open wall": "open"}
SIZES = ((16, 0.6), (32, 0.3), (64, 0.15))
FINEST = {"degree": 4, "cells_per_gap": 2.0, "cells_per_circle": 96, "growth": 0.1}


def case(top: Any, **sizes: Any) -> Case:
    """A disc that moves beside the middle of a square box."""
    disc = {"radius": 0.5, "position": [1.6, 1.9], "velocity": [0.3, -0.4], "angular_velocity": 0.2}
    domain = {"lower": [0.0, 0.0], "upper": [4.0, 4.0], "walls": {"top": top}}
    return parse_case(
        {
            "name": "jumps at corners",
            "fluid": {"viscosity": 1.0},
            "domain": domain,
            "bodies": [{"name": "disc", **disc}],
            "discretisation": sizes,
        }
    )


def row(top: Any, degree: int, exact: Array) -> list[str]:
    """Cells, errors, orders and bars for all sizes of cells."""
    errors, cells = [], []
    for circle, growth in SIZES:
        solved = solve_with_errors(case(top, degree=degree, cells_per_circle=circle, growth=growth))
        largest = np.abs(solved.solution.F - exact).max()
        errors.append(largest)
        cells.append(f"{solved.solution.cells}: {largest:.1e}, {solved.errors.F.max() / largest:.2f}")
    orders = ", ".join(f"{np.log2(before / after):.1f}" for before, after in pairwise(errors))
    return [str(degree), *cells, orders]


def main() -> None:
    """Print the table."""
    table = Table("wall", "degree", *(f"{circle}, {growth}" for circle, growth in SIZES), "orders")
    for wall, top in WALLS.items():
        finest = case(top, **FINEST)
        exact = StokesModel(finest)(finest.configuration(), 0.0).F
        for degree in (2, 3):
            table.add_row(wall, *row(top, degree, exact))
    console = Console(width=120)
    console.print("cells: error of the force, bar over error; below cells_per_circle, growth")
    console.print(table)


if __name__ == "__main__":
    main()
