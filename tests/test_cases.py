"""Every case at time 0 gives the numbers that stand in its file."""

from pathlib import Path

import numpy as np
import pytest

from fsi.case import Case, load_case
from fsi.schema import Expected
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution
from fsi.truncation import halved, truncation

CASES = Path(__file__).parents[1] / "cases"
AT_ONE_INSTANT = [path for path in sorted(CASES.glob("*.toml")) if load_case(path).time is None]


def computed(case: Case, solution: StokesSolution, row: Expected) -> float:
    """The quantity of an expected row, like `disc.force.y`."""
    body, quantity, *component = row.quantity.split(".")
    values = solution.U if "velocity" in quantity else -solution.F
    k = "xy".index(component[0]) if component else 2
    return float(values[case.names.index(body), k])


@pytest.mark.parametrize("path", AT_ONE_INSTANT, ids=lambda path: path.stem)
def test_case(path: Path) -> None:
    case = load_case(path)
    solution = StokesModel(case)(case.configuration(), 0.0)
    for row in case.expected:
        assert computed(case, solution, row) == pytest.approx(row.value, rel=row.rtol), row.quantity


@pytest.mark.parametrize("name", ["disc_beside_plane", "free_disc_in_shear"])
def test_the_truncation_is_below_the_tolerance_of_the_case(name: str) -> None:
    case = load_case(CASES / f"{name}.toml")
    half = halved(case)
    assert half is not None
    whole, smaller = (StokesModel(one)(one.configuration(), 0.0) for one in (case, half))
    assert max(truncation(case, whole, smaller).values()) < min(row.rtol for row in case.expected)


def test_a_finer_mesh_gives_the_force_in_the_box_to_the_digits_of_its_source() -> None:
    finer = [f"discretisation.{setting}" for setting in ("degree=4", "cells_per_gap=3", "growth=0.25")]
    case = load_case(CASES / "disc_in_box.toml", finer)
    solution = StokesModel(case)(case.configuration(), 0.0)
    np.testing.assert_allclose(-solution.F[0, 1], case.expected[0].value, rtol=1e-7)
