"""Gaps down to 1e-8 radii: forces against closed forms, and with how many unknowns; see `bench/gaps.py`."""

import numpy as np
import pytest

from bench.gaps import CASES, PROBLEMS, measured
from fsi.case.case import Case
from fsi.case.load import load_case
from fsi.stokes.model import StokesModel
from fsi.stokes.resistance import case_resistance


@pytest.mark.parametrize("name", ["disc towards a plane", "two discs", "sphere towards a plane"])
def test_forces_in_gaps_of_1e_8_radii(name: str) -> None:
    """Within 1e-5 of the closed forms with at most twice the unknowns at 1e-3.

    With nodes that do not face each other the disc towards the plane is 8e-4 off at 1e-8; with cells no
    longer than four gaps it takes 60 times as long.
    """
    problem = PROBLEMS[name]
    _, at_ease, _ = measured(problem, 1e-3)
    for gap in (1e-6, 1e-7, 1e-8):
        error, unknowns, _ = measured(problem, gap)
        assert abs(error) < 1e-5
        assert unknowns < 2 * at_ease


def in_corner(gap: float, *motion: str) -> Case:
    places = [f"bodies.0.position=[{1.0 + gap!r}, {1.0 + gap!r}]"]
    return load_case(
        CASES / "disc_in_box.toml",
        [*places, "domain.lower=[0.0, 0.0]", "domain.upper=[16.0, 16.0]", *motion],
    )


@pytest.mark.parametrize(("gap", "rtol"), [(1.8e-5, 1e-4), (1e-6, 1e-5), (1e-8, 1e-5)])
def test_a_disc_in_a_corner(gap: float, rtol: float) -> None:
    """The fluid that it shuts in leaves through two gaps: F = (9 pi sqrt(2) / 4) mu V (q/a)^(-5/2).

    By lubrication theory (own derivation): half of V a leaves through each, at the pressure p with
    `V a / 2 = p / (12 mu int dx / d^3)`, int dx / d^3 = (3 pi / 8) sqrt(2 a) q^(-5/2), and F = p a; what it
    neglects is of order q/a. Measured by |b - M x| / |b|, and refined once, all three solves were refused.
    """
    case = in_corner(gap, "bodies.0.velocity=[0.0, -1.0]")
    solution = StokesModel(case)(case.configuration(), 0.0)
    leading = 2.25 * np.pi * np.sqrt(2.0) * ((1.0 + gap) - 1.0) ** -2.5
    np.testing.assert_allclose(-solution.F[0, :2], leading, rtol=rtol)
    assert solution.checks["residual"] < 1e-9


@pytest.mark.parametrize(("gap", "rtol"), [(1e-7, 1e-3), (1e-8, 2e-3)])
def test_loads_in_a_corner_do_not_drown_in_the_pressure_there(gap: float, rtol: float) -> None:
    """F_x of a turning disc is the torque of one that moves along x, by reciprocity.

    The pressure is 1e18 and more times that beside the disc. With its values in double precision the force
    was a third of the torque at 1e-7, and R was refused with an asymmetry of 4.5e-8.
    """
    held = "bodies.0.velocity=[0.0, 0.0]", "bodies.0.angular_velocity=1.0"
    turning = in_corner(gap, *held)
    found, R = StokesModel(turning)(turning.configuration(), 0.0), case_resistance(turning)
    np.testing.assert_allclose(found.F[0, :2], R.R[2, :2], rtol=rtol)
    assert R.checks["reciprocity"] < 1e-9
    assert R.eigenvalues[0] == pytest.approx(R.R[2, 2], rel=1e-3)


def test_a_disc_that_is_free_in_a_corner_has_digits_left() -> None:
    """The residual was 1e-9, its bound; U is what the mobility says.

    To rounding: terms of 7e19 are added up to loads of 1 in 64 bits, which leaves 3e-5 of U in one order and
    1e-5 in another, and doubles have 11 bits less.
    """
    free = ["velocity=['free', 'free']", "angular_velocity='free'", "force=[1.0, 0.5]", "torque=0.3"]
    pushed = in_corner(1e-8, *(f"bodies.0.{key}" for key in free))
    solution, R = StokesModel(pushed)(pushed.configuration(), 0.0), case_resistance(pushed)
    assert solution.checks["residual"] < 1e-12
    assert R.mobility is not None
    np.testing.assert_allclose(solution.U[0], R.mobility @ [1.0, 0.5, 0.3], rtol=2e-4)
