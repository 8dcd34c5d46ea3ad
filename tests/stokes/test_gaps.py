"""Gaps down to 1e-8 radii: forces against closed forms, at the cost of wide ones; see `bench/gaps.py`."""

import numpy as np
import pytest

from bench.gaps import CASES, PROBLEMS, measured
from fsi.case.load import load_case
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


@pytest.mark.parametrize(("gap", "rtol"), [(1.8e-5, 1e-4), (1e-6, 1e-5), (1e-8, 1e-5)])
def test_a_disc_in_a_corner(gap: float, rtol: float) -> None:
    """The fluid that it shuts in leaves through two gaps: F = (9 pi sqrt(2) / 4) mu V (q/a)^(-5/2).

    By lubrication theory (own derivation): half of V a leaves through each, at the pressure p with
    `V a / 2 = p / (12 mu int dx / d^3)`, int dx / d^3 = (3 pi / 8) sqrt(2 a) q^(-5/2), and F = p a; what it
    neglects is of order q/a. Measured by |b - M x| / |b|, and refined once, all three solves were refused.
    """
    places = [f"bodies.0.position=[{1.0 + gap!r}, {1.0 + gap!r}]", "bodies.0.velocity=[0.0, -1.0]"]
    walls = ["domain.lower=[0.0, 0.0]", "domain.upper=[16.0, 16.0]"]
    case = load_case(CASES / "disc_in_box.toml", [*places, *walls])
    solution = StokesModel(case)(case.configuration(), 0.0)
    leading = 2.25 * np.pi * np.sqrt(2.0) * ((1.0 + gap) - 1.0) ** -2.5
    np.testing.assert_allclose(-solution.F[0, :2], leading, rtol=rtol)
    assert solution.checks["residual"] < 1e-9
