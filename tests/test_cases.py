"""Every case at time 0 gives the numbers that stand in its file."""

from pathlib import Path

import pytest

from fsi.case.load import load_case
from fsi.models import make_model
from fsi.observables.quantities import computed
from fsi.observables.truncation import halved, truncation
from fsi.reduced.model import ReducedInstant
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution
from fsi.validation.resolved import largest_of_kind
from fsi.validation.rows import reference

CASES = Path(__file__).parents[1] / "cases"
FILES = sorted([*CASES.glob("*.toml"), *CASES.glob("slides/*.toml")])
AT_ONE_INSTANT = {path: case for path in FILES if (case := load_case(path)).time is None}


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=pytest.mark.slow if case.geometry == "spatial" else ())
        for path, case in AT_ONE_INSTANT.items()
    ],
    ids=lambda path: path.stem,
)
def test_case(path: Path) -> None:
    case = load_case(path)
    solution = make_model(case)(case.configuration(), 0.0)
    assert isinstance(solution, StokesSolution | ReducedInstant)
    for row in case.expected:
        value, _ = reference(case, row)
        size = abs(value) or largest_of_kind(case, solution, row.quantity)
        near = pytest.approx(value, rel=0.0, abs=row.rtol * size)
        assert computed(case, solution, row.quantity) == near, row.quantity


@pytest.mark.parametrize("name", ["disc_beside_plane", "free_disc_in_shear"])
def test_the_truncation_is_below_the_tolerance_of_the_case(name: str) -> None:
    case = load_case(CASES / f"{name}.toml")
    half = halved(case)
    assert half is not None
    whole, smaller = (StokesModel(one)(one.configuration(), 0.0) for one in (case, half))
    assert max(truncation(case, whole, smaller).values()) < min(row.rtol for row in case.expected)
