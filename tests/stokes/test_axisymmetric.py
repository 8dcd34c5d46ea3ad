"""Spheres on an axis: the sphere-plane and two-sphere series.

Convergence, agreement of both forms, settling.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

from fsi.arrays import Array
from fsi.bodies.configuration import Motion
from fsi.case.load import parse_case
from fsi.lubrication.spheres import line_forces
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.round import HalfPlane, Round
from fsi.meshes.resolution import Resolution
from fsi.postprocess.run.run import open_run
from fsi.runs import run
from fsi.stokes.problem import SolverOptions, StokesProblem
from fsi.stokes.solve import solve
from fsi.stokes.traction import traction
from tests.flows import discs, free, mesh, resting, solved
from tests.nested import nested_meshes

REFERENCE = Path(__file__).parents[1] / "reference"
HALF_SPACE = HalfPlane(1000.0, axisymmetric=True)
CYLINDER = Box((0.0, -4.0), (3.0, 4.0), axisymmetric=True)
FINE = Resolution(2.0, 64, 0.12)
STOKES = 6.0 * np.pi  # drag of a sphere of radius 1 at speed 1 in unbounded fluid


def reference(name: str) -> Any:
    return json.loads((REFERENCE / f"{name}.json").read_text())


def along_axis(*speeds: float) -> Motion:
    """All spheres held at these V_z."""
    U = np.zeros((len(speeds), 3))
    U[:, 1] = speeds
    return Motion(np.ones(U.shape, dtype=bool), U, np.zeros_like(U))


def falling(*loads: float) -> Motion:
    """All spheres free along z under these F_z."""
    motion = free(*[(0.0, load, 0.0) for load in loads])
    motion.held[:, [0, 2]] = True
    return motion


def spheres(*heights: float, radii: Any = None) -> Any:
    return discs([(0.0, z) for z in heights], radii or [1.0] * len(heights))


@pytest.mark.parametrize(
    "row", reference("sphere_wall_normal")["rows"], ids=lambda row: f"{row['q_over_a']:g}"
)
def test_sphere_towards_a_plane(row: dict[str, float]) -> None:
    """Brenner 1961 to 1e-5 at default settings.

    The leading term 6 pi mu a^2 U / q is 12.7 % off at q/a = 0.1.
    """
    F = solved(HALF_SPACE, spheres(1.0 + row["q_over_a"]), along_axis(-1.0)).F
    assert -F[0, 1] / STOKES == pytest.approx(row["lambda"], rel=1e-5)
    assert F[0, 0] == F[0, 2] == 0.0


@pytest.mark.parametrize("gap", [1.0, 0.01, 1e-5])
def test_sphere_towards_a_plane_at_a_fine_setting(gap: float) -> None:
    """To 1e-8, the truncation at 1000 radii included."""
    expected = {row["q_over_a"]: row["lambda"] for row in reference("sphere_wall_normal")["rows"]}[gap]
    F = solved(HALF_SPACE, spheres(1.0 + gap), along_axis(-1.0), resolution=FINE, degree=4).F
    assert -F[0, 1] / STOKES == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("row", reference("two_spheres")["rows"], ids=lambda row: f"{row['gap_over_a']:g}")
def test_two_spheres_approaching(row: dict[str, float]) -> None:
    """Maude 1961 to 1e-5; no net force, so a ball of 500 radii changes it by some (a / R)^3."""
    z = 1.0 + 0.5 * row["gap_over_a"]
    F = solved(Round(500.0, axisymmetric=True), spheres(-z, z), along_axis(1.0, -1.0)).F[:, 1]
    assert F[0] / STOKES == pytest.approx(row["approach"], rel=1e-5)
    assert F[1] == pytest.approx(-F[0], rel=1e-5)


@pytest.mark.parametrize(("radius", "gap"), [(0.02, 0.2), (0.01, 0.05), (0.002, 0.002)])
def test_a_small_sphere_comes_to_a_large_one(radius: float, gap: float) -> None:
    """Maude 1961, as `line_forces` has it, to 1e-4.

    Cells on the axis that had the size of those on the large sphere gave 8 %, 18 % and 230 % more.
    """
    expected = line_forces(gap, (1.0, radius), 1.0, (0.0, -1.0))[1]
    q = spheres(0.0, 1.0 + radius + gap, radii=[1.0, radius])
    F = solved(Round(1000.0, axisymmetric=True), q, along_axis(0.0, -1.0)).F
    assert F[1, 1] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("ratio", [0.2, 0.5])
def test_sphere_in_the_middle_of_a_ball(ratio: float) -> None:
    """Cunningham 1910: K = (1 - l^5) / (1 - 9 l / 4 + 5 l^3 / 2 - 9 l^5 / 4 + l^6).

    L = a / R. K(0.5) = 7.3.
    """
    powers = ratio ** np.arange(7)
    K = (1 - powers[5]) / (powers @ [1, -2.25, 0, 2.5, 0, -2.25, 1])
    F = solved(Round(1.0 / ratio, axisymmetric=True), spheres(0.0), along_axis(1.0)).F
    assert F[0, 1] / STOKES == pytest.approx(K, rel=1e-5)


@pytest.mark.parametrize(("degree", "least"), [(2, 3.5), (3, 5.5)])
def test_force_converges_at_twice_the_degree(degree: int, least: float) -> None:
    """Against Brenner's series at q = a.

    Cells whose hoop strain is integrated too coarsely would lose an order.
    """
    expected = -STOKES * 2.1255355667600404
    q, container = spheres(2.0), HalfPlane(2000.0, axisymmetric=True)
    problems = [
        StokesProblem(fluid, container, q, along_axis(-1.0), resting(container))
        for fluid in nested_meshes(container, q, Resolution(1.0, 12, 0.8), degree, 3)
    ]
    errors = [abs(solve(one, SolverOptions(degree)).F[0, 1] / expected - 1) for one in problems]
    assert np.log2(errors[1] / errors[2]) >= least


def test_multiplier_and_eliminated_form_agree() -> None:
    """Two spheres, one held and one falling, in a cylinder: U, lambda and loads to 1e-9."""
    q = spheres(-1.3, 1.1, radii=[1.0, 0.7])
    motion = falling(0.0, -3.0)
    motion.held[0, 1] = True
    motion.U[0, 1] = 0.5
    fluid = mesh(CYLINDER, q, Resolution(0.7, 16, 0.4))
    problem = StokesProblem(fluid, CYLINDER, q, motion, resting(CYLINDER))
    a, b = (solve(problem, SolverOptions(formulation=form)) for form in ("eliminated", "multiplier"))
    for x, y in ((a.U, b.U), (a.F, b.F), (a.surface.reaction, b.surface.reaction)):
        assert_allclose(x, y, rtol=0, atol=1e-9 * np.abs(x).max())
    assert max(a.checks.values()) < 1e-8
    assert a.F[1, 1] == pytest.approx(-3.0, rel=1e-12)


def test_traction_of_a_lone_sphere_is_uniform() -> None:
    """Stokes 1851: 3 mu U / (2 a) along the motion at every point, to 1 %; the pressure's part alone varies
    by 100 %.
    """
    solution = solved(Round(20000.0, axisymmetric=True), spheres(0.0), along_axis(1.0))
    t = traction(solution.surface)
    assert_allclose(t - [0.0, 1.5], 0.0, atol=0.015)


def test_a_uniform_stream_carries_the_sphere_along() -> None:
    """A free sphere in a ball whose wall moves at (0, U) moves with it, without dissipation."""
    ball = Round(10.0, axisymmetric=True)
    boundary = resting(ball)
    boundary = type(boundary)({"far": lambda x: np.tile([0.0, 2.0], (len(x), 1))}, {})
    solution = solved(ball, spheres(1.0), falling(0.0), boundary)
    assert solution.U[0, 1] == pytest.approx(2.0, rel=1e-10)
    assert solution.dissipation < 1e-18


def time_at(gap: float, t: Array, gaps: Array) -> float:
    """When the gap was passed; ln q is nearly linear in t."""
    return float(CubicSpline(-np.log(gaps), t)(-np.log(gap)))


@pytest.mark.slow
def test_settling_sphere(tmp_path: Path) -> None:
    """tau at q/a = 0.5, 0.1, 0.01, 1e-4 within 1e-3 (settling.json); it never touches."""
    case = parse_case(
        {
            "name": "settling sphere",
            "geometry": "axisymmetric",
            "fluid": {"viscosity": 1.0},
            "domain": {"shape": "half-plane", "radius": 1000.0},
            "bodies": [{"name": "sphere", "radius": 1.0, "position": [0.0, 2.0], "force": [0.0, -STOKES]}],
            "discretisation": {"cells_per_circle": 32, "growth": 0.3},
            "time": {"end": 10.6},
            "output": {"fields": False},
        }
    )
    run(case, tmp_path / "run")
    table = open_run(tmp_path / "run").columns("steps")
    for s, tau in reference("settling")["sphere"]["tau"].items():
        assert time_at(float(s), table["t"], table["smallest_gap"]) == pytest.approx(tau, rel=1e-3), s
    assert (table["smallest_gap"] > 0).all()
