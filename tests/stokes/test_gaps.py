"""Gaps down to 1e-8 radii: forces against closed forms, and with how many unknowns; see `bench/gaps.py`."""

from pathlib import Path

import numpy as np
import pytest

from bench.gaps import CASES, PROBLEMS, measured
from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.errors import SolveError
from fsi.postprocess.run.run import open_run
from fsi.runs import run
from fsi.stokes.adapt import solve_with_errors
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


# 4 pi C of the stream function in bipolar coordinates (Jeffery 1922, Proc. R. Soc. A 101:169), to 60 digits.
SQUEEZED = {1.99999: 774332847.28703520, 1.999999: 24486317742.952324, 1.9999999: 774324605850.37329}


@pytest.mark.parametrize("x", SQUEEZED)
def test_the_force_and_its_bar_beside_a_round_wall(x: float) -> None:
    """Rounded where they stand, cells lose digits by their distance from the origin: 4e-7 at a gap of 1e-7.

    Both degrees lose the same, and the bar was a third of that and less.
    """
    body = {
        "name": "disc",
        "radius": 1.0,
        "position": [x, 0.0],
        "velocity": [1.0, 0.0],
        "angular_velocity": 0.0,
    }
    round_wall = {"shape": "round", "radius": 3.0}
    data = {"name": "t", "fluid": {"viscosity": 1.0}, "domain": round_wall, "bodies": [body]}
    found = solve_with_errors(parse_case(data))
    F, error = abs(found.solution.F[0, 0]), found.errors.F[0, 0]
    assert pytest.approx(SQUEEZED[x], rel=5e-9) == F
    assert abs(F - SQUEEZED[x]) < error < 1e-7 * F


@pytest.mark.parametrize(("gap", "degree"), [(1e-8, 3), (5.4e-8, 3), (4.1289e-7, 2)])
def test_a_disc_pushed_into_a_corner_turns_by_less_than_its_bar(gap: float, degree: int) -> None:
    """By symmetry it does not turn, but for the open top, by 1e-6 (finer meshes). Rounding turns it.

    By eps V / q^2 as a pressure of q^(-5/2) leaves a torque against a resistance of q^(-1/2); of 40 discs by
    up to 9.8 bars of the difference of two degrees.
    """
    coarse = [
        f"discretisation.degree={degree}",
        "discretisation.cells_per_circle=20",
        "discretisation.growth=0.5",
    ]
    box = ["domain.upper=[4.0, 4.0]", "domain.walls.top='open'"]
    pushed = ["bodies.0.velocity=[-0.01, -0.01]", "bodies.0.angular_velocity='free'"]
    found = solve_with_errors(in_corner(gap, *box, *coarse, *pushed))
    turn, error = abs(found.solution.U[0, 2]), found.errors.U[0, 2]
    assert turn < error + 1e-6
    assert error < 100.0 * np.finfo(float).eps * 0.01 / gap**2


def test_a_run_ends_where_a_gap_is_no_longer_resolved(tmp_path: Path) -> None:
    """A velocity that closes the gap: from 1.2e-8 on omega and V_x were rounding, with exit code 0."""
    places = ["bodies.0.position=[0.0, 1.000000015]", "bodies.0.velocity=['free', -1.0]"]
    time = ["time.end=1e-8", "time.gap_loss=0.7", "output.fields=false"]
    box = ["domain.lower=[-4.0, 0.0]", "domain.upper=[4.0, 6.0]"]
    case = load_case(CASES / "disc_in_box.toml", [*places, *box, *time])
    with pytest.raises(
        SolveError, match=r"^bodies: at t = \S+ the gap between 'disc' and 'bottom' is \S+, \S+ radii"
    ):
        run(case, tmp_path / "run")
    gaps = open_run(tmp_path / "run").steps["smallest_gap"].to_numpy()
    assert gaps.min() >= 0.9e-8


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
