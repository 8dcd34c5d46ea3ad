"""Gaps down to 1e-8 radii: forces against closed forms, at the cost of wide ones; see `bench/gaps.py`."""

import pytest

from bench.gaps import CASES, PROBLEMS, measured
from fsi.case.load import load_case
from fsi.lubrication import exact
from fsi.stokes.model import StokesModel


@pytest.mark.parametrize("name", ["disc towards a plane", "two discs", "sphere towards a plane"])
def test_forces_in_gaps_of_1e_8_radii(name: str) -> None:
    """Within 1e-5 of the closed forms in at most three times the CPU seconds at 1e-3.

    With nodes that do not face each other the disc towards the plane is 8e-4 off at 1e-8; with cells no
    longer than four gaps it takes 60 times as long.
    """
    problem = PROBLEMS[name]
    _, _, at_ease = measured(problem, 1e-3)
    for gap in (1e-6, 1e-7, 1e-8):
        error, _, seconds = measured(problem, gap)
        assert abs(error) < 1e-5
        assert seconds < 3.0 * at_ease


@pytest.mark.parametrize("gap", [1.8e-5, 1e-8])
def test_a_disc_in_a_corner(gap: float) -> None:
    """The force along the normal of one wall is that beside it alone, and what else there is hardly counts.

    That beside a plane is singular like q^(-3/2), what the second wall adds like q^(-1/2): a part of order q.
    Measured by |b - M x| / |b| both solves left more than 1e-8 and were refused.
    """
    places = [f"bodies.0.position=[{-8.0 + 1.0 + gap!r}, {1.0 + gap!r}]", "bodies.0.velocity=[0.0, -1.0]"]
    case = load_case(CASES / "disc_in_box.toml", places)
    solution = StokesModel(case)(case.configuration(), 0.0)
    alone = float(exact.normal_resistance((1.0 + gap) - 1.0, 1.0, 1.0))
    assert -solution.F[0, 1] == pytest.approx(alone, rel=1e-5 + 4.0 * gap)
    assert solution.checks["residual"] < 1e-12
    assert solution.checks["power"] < 1e-10
