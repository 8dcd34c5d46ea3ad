"""Many discs in one cell: numbers grow with its size, identities must not lose their digits."""

from pathlib import Path

from fsi.case.load import load_case
from fsi.pores.model import PoreModel

CASES = Path(__file__).parents[2] / "cases"


def test_identities_of_a_crowd_keep_their_digits() -> None:
    """Counted from one place for the whole cell, velocities and fluxes would leave 3e-8 and 6e-8 here."""
    case = load_case(CASES / "pores" / "crowd.toml", ["arrangement.number=400"])
    found = PoreModel(case)(case.configuration(), 0.0)
    assert found.checks["power"] < 1e-9
    assert found.checks["stress"] < 1e-9
    assert found.apparent_viscosity is not None
    assert found.apparent_viscosity > 1.0 / (1.0 - 0.4)
