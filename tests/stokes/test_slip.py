"""Fluid that slides along bodies and walls."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import fsi.meshes.backend

import basix
import numpy as np
import pytest
from numpy.testing import assert_allclose

import fsi
from fsi.arrays import Array
from fsi.lubrication.concentric import Concentric
from fsi.lubrication.sliding_film import sphere_resistance
from fsi.meshes.resolution import Resolution
from fsi.stokes.discretisation.forms import EQUISPACED
from fsi.stokes.discretisation.slip import FACET, continued, masses
from fsi.stokes.problem import StokesProblem, SurfaceConditions
from fsi.stokes.resistance import case_resistance
from fsi.stokes.solve import solve
from fsi.stokes.solvers.workspace import Workspace
from tests.flows import SMALL_BOX, discs, held, mesh, resting
from tests.ranks import json_on
from tests.stokes.sliding_flows import COARSE, balanced, body, in_ball
from tests.stokes.test_mpi import numbers

SLIPS = [(0.5, 0.0), (0.0, 0.4), (0.3, 0.7)]


@pytest.mark.parametrize(("b", "c"), [*SLIPS, (1e-9, 0.0)])
def test_a_disc_in_a_round_container(b: float, c: float) -> None:
    """Drag and torque to 2e-5 and within the bars: without slip on one of both they are 8 % to half off."""
    solved = balanced(
        in_ball("planar", c, body(velocity=[1.0, 0.0], angular_velocity=2.0, slip_length=b), **COARSE)
    )
    exact = Concentric(1.0, 3.0, b, c, spheres=False)
    F, errors = solved.solution.F[0, [0, 2]], solved.errors
    reference = np.array([exact.force(1.0, 0.0, 0.7), exact.torque(2.0, 0.7)])
    assert_allclose(F, reference, rtol=2e-5)
    assert np.all(np.abs(F - reference) < errors.F[0, [0, 2]])


@pytest.mark.parametrize(("b", "c"), SLIPS)
def test_a_sphere_on_the_axis(b: float, c: float) -> None:
    """Drag to 1e-5 and within the bar."""
    solved = balanced(in_ball("axisymmetric", c, body(velocity=[0.0, 1.0], slip_length=b)))
    reference = Concentric(1.0, 3.0, b, c, spheres=True).force(1.0, 0.0, 0.7)
    assert_allclose(solved.solution.F[0, 1], reference, rtol=1e-5)
    assert abs(solved.solution.F[0, 1] - reference) < solved.errors.F[0, 1]


def test_order() -> None:
    """Of a turning disc with slip in a ring: half the size, a 29th, as without slip; order 4: 16th."""
    exact, errors = Concentric(1.0, 3.0, 0.3, 0.7, spheres=False).torque(1.0, 0.7), []
    disc = body(velocity=[0.0, 0.0], angular_velocity=1.0, slip_length=0.3)
    for cells, growth in ((24, 0.4), (48, 0.2)):
        sizes = {"cells_per_circle": cells, "growth": growth}
        errors.append(balanced(in_ball("planar", 0.7, disc, **sizes)).solution.F[0, 2] / exact - 1.0)
    assert abs(errors[1]) < abs(errors[0]) / 24.0


def test_resistance_is_symmetric_and_slip_lowers_it() -> None:
    """Of two discs of different slip, off centre, whose surfaces swim, which does not count."""
    pair = [body((-1.2, 0.2)), {**body((1.2, -0.3)), "name": "other", "radius": 0.8}]
    R = []
    for slips in ((0.0, 0.0), (0.5, 0.1)):
        sliding = [
            one | {"slip_length": b, "surface_velocity": [1.0]} for one, b in zip(pair, slips, strict=True)
        ]
        found = case_resistance(in_ball("planar", 0.0, *sliding, **COARSE))
        assert found.checks["reciprocity"] < 1e-10
        R.append(found.R)
    assert np.linalg.eigvalsh(R[0] - R[1]).min() > 0.0


def shear(dimension: int, b: float) -> dict[str, Any]:
    """A box in which u = h e_x is exact: bottom and top slide past fluid that moves b slower or faster."""
    rest = (0.0,) * (dimension - 1)
    plates = {"bottom": -b, "top": 1.5 + b}
    walls: dict[str, Any] = {name: {"slip_length": b, "velocity": (u, *rest)} for name, u in plates.items()}
    names = ("left", "right", "front", "back")[: 2 * (dimension - 1)]
    walls |= {name: {"shear": 1.0} for name in names}
    return {"lower": (0.0,) * dimension, "upper": (2.0, *(1.0,) * (dimension - 2), 1.5), "walls": walls}


@pytest.mark.parametrize("geometry", ["planar", "spatial"])
def test_couette_flow_between_sliding_plates_is_exact(geometry: str) -> None:
    """To rounding, in the corners too, where the sides hold the fluid that the plates move past."""
    d = 2 if geometry == "planar" else 3
    case = fsi.make_case(
        name="plates", geometry=geometry, fluid={"viscosity": 0.7}, domain=shear(d, 0.4), bodies=[],
        discretisation={"degree": 2},
    )  # fmt: skip
    solved = balanced(case)
    upper = np.array([2.0, *(1.0,) * (d - 2), 1.5])
    x = np.random.default_rng(1).uniform(0.1, 0.9, (20, d)) * upper
    u = np.zeros_like(x)
    u[:, 0] = x[:, -1]
    assert_allclose(solved.solution.velocity(x), u, atol=1e-11)
    volume = float(np.prod(upper))
    assert_allclose(solved.solution.dissipation, 0.7 * volume, rtol=1e-11)
    # On each plate the slip is b: (mu / b) b^2 times two plates.
    assert_allclose(solved.solution.record["slip_dissipation"], 2.0 * 0.7 * 0.4 * volume / 1.5, rtol=1e-11)


def test_couette_flow_in_a_channel_with_slip() -> None:
    """u = (y + b) / (H + b + c) U; the walls' stress is that of the bulk, and what the dissipation says."""
    walls = {"bottom": {"slip_length": 0.2}, "top": {"slip_length": 0.3, "velocity": [1.0, 0.0]}}
    domain = {"lower": [0.0, 0.0], "upper": [4.0, 3.0], "periodic": ["x"], "walls": walls}
    case = fsi.make_case(name="channel", fluid={"viscosity": 0.7}, domain=domain, bodies=[])
    solution = balanced(case).solution
    assert_allclose(solution.velocity(np.array([[1.0, 1.0], [3.9, 2.0]]))[:, 0], [1.2 / 3.5, 2.2 / 3.5])
    assert solution.apparent_viscosity is not None
    assert_allclose(solution.apparent_viscosity, 3.0 / 3.5)


def test_a_sliding_disc_is_the_same_wherever_the_period_is_cut() -> None:
    """To its mesh error; the cut goes around it, or through it, and through sliding walls."""
    walls = {"bottom": {"slip_length": 0.2}, "top": {"slip_length": 0.3, "velocity": [1.0, 0.0]}}
    domain = {"lower": [0.0, 0.0], "upper": [4.0, 2.4], "periodic": ["x"], "walls": walls}
    found = []
    for x in (2.0, 3.95):
        disc = body((x, 1.25), slip_length=0.4, surface_velocity=[0.1])
        case = fsi.make_case(
            name="channel", fluid={"viscosity": 0.7}, domain=domain, bodies=[disc], discretisation=COARSE
        )
        found.append(balanced(case).solution.U)
    assert_allclose(found[1], found[0], atol=1e-5)


def test_a_sphere_towards_a_plane_with_slip_on_both() -> None:
    """The law of the film but for some mu a V; without slip the force is 2.4 times that."""
    q, b = 1e-3, 1e-3
    domain = {"shape": "half-plane", "radius": 500.0, "walls": {"plane": {"slip_length": b}}}
    ball = body((0.0, 1.0 + q), velocity=[0.0, -1.0], slip_length=b)
    case = fsi.make_case(
        name="film", geometry="axisymmetric", fluid={"viscosity": 1.0}, domain=domain, bodies=[ball]
    )
    solved = balanced(case)
    rest = -solved.solution.F[0, 1] - float(sphere_resistance(q, 1.0, b, 1.0))
    assert 0.0 < rest < 2.0 * 6.0 * np.pi


def test_a_lid_that_slides_past_walls_is_not_singular() -> None:
    """Its dissipation is finite; that of one that fluid sticks to is not (see `corners`)."""
    domain = {
        "lower": (0.0, 0.0),
        "upper": (1.0, 1.0),
        "walls": {"top": {"slip_length": 0.1, "velocity": (1.0, 0.0)}},
    }
    case = fsi.make_case(name="lid", fluid={"viscosity": 1.0}, domain=domain, bodies=[], discretisation={})
    assert np.isfinite(balanced(case).solution.dissipation)


def test_units() -> None:
    """A slip length is a length, and the modes of a swimmer are velocities."""
    found = []
    for length in (1.0, 1e-6):
        swimmer = body(surface_velocity=[length, -2.0 * length], slip_length=0.3 * length)
        swimmer["radius"] = length
        case = in_ball("planar", 0.7 * length, swimmer, R=3.0 * length, **COARSE)
        found.append(balanced(case).solution.U / [length, length, 1.0])
    assert_allclose(found[0], found[1], rtol=1e-10, atol=1e-13)


def test_a_workspace_takes_other_slip_lengths() -> None:
    """What a solve finds from the one before, with another slip length or none, changes no digit."""
    q = discs([(-1.2, 0.2), (1.1, -0.1)], [1.0, 0.8])
    fluid = mesh(SMALL_BOX, q, Resolution(1.0, 24, 0.5))
    motion = held((1.0, 0.0, 0.5), (0.0, 0.0, 0.0))

    def found(b: float, c: float, workspace: Workspace | None) -> Array:
        boundary = replace(resting(SMALL_BOX), slip_lengths={"top": c} if c else {})
        surfaces = SurfaceConditions({0: b} if b else {})
        return solve(
            StokesProblem(fluid, SMALL_BOX, q, motion, boundary, surfaces=surfaces), workspace=workspace
        ).F

    with Workspace() as workspace:
        for slips in ((0.3, 0.0), (0.1, 0.0), (0.0, 0.0), (0.1, 0.5), (0.1, 0.0)):
            assert_allclose(found(*slips, workspace), found(*slips, None), rtol=1e-12)


@pytest.mark.parametrize(("d", "degree"), [(2, 3), (3, 2)])
def test_masses_of_facets(d: int, degree: int) -> None:
    """On straight facets they add up to length or area, and to the normal times it."""
    corners = (
        np.array([[[0.0, 0.0], [3.0, 4.0]]]) if d == 2 else np.array([[[0.0, 0, 0], [2, 0, 0], [0, 2, 1]]])
    )
    X = basix.create_element(basix.ElementFamily.P, FACET[d], degree, EQUISPACED).points
    x = np.column_stack([1.0 - X.sum(axis=1), X]) @ corners
    mass, normal = masses(x, degree, axisymmetric=False)
    assert_allclose(mass.sum(), 5.0 if d == 2 else np.sqrt(5.0))
    assert_allclose(normal.sum(axis=(0, 1, 2)), [4.0, -3.0] if d == 2 else [0.0, -1.0, 2.0], atol=1e-14)


@pytest.mark.parametrize("stuck", [[0], [1], [0, 1]])
@pytest.mark.parametrize("degree", [2, 3, 5])
def test_the_pressure_on_a_wall_is_of_a_lower_degree_beside_corners(degree: int, stuck: list[int]) -> None:
    """What is tested with polynomials of that degree stays; the neighbour's value would do for constants."""
    X = basix.create_element(basix.ElementFamily.P, FACET[2], degree, EQUISPACED).points[:, 0]
    _, normal = masses(np.stack([X, 0.3 * X**2], axis=1)[None], degree, axisymmetric=False)
    absent = np.isin(np.arange(degree + 1), stuck)
    folded = continued(normal, absent[None])[0, ~absent]
    powers = np.vander(X, degree + 1 - len(stuck))
    of_all = np.tensordot(powers.T, normal[0], 1)
    assert_allclose(np.tensordot(powers[~absent].T, folded, 1), of_all, rtol=0, atol=1e-13)


CASE = """
name = "sliding discs"
[fluid]
viscosity = 0.7
[domain]
lower = [-4.0, 0.0]
upper = [4.0, 6.0]
walls.top = { slip_length = 0.3, velocity = [1.0, 0.0] }
walls.bottom = { slip_length = 0.1 }
profiles.bottom = { kind = "wave", height = -0.15, length = 4.0, number = 2, start = -4.0 }
[discretisation]
cells_per_circle = 24
growth = 0.4
[[bodies]]
name = "free"
radius = 1.0
position = [-1.2, 1.05]
force = [0.0, -1.0]
slip_length = 0.2
[[bodies]]
name = "swimmer"
radius = 1.0
position = [0.9, 2.5]
velocity = [0.3, "free"]
angular_velocity = 0.5
slip_length = 0.1
surface_velocity = [0.5, 1.0]
"""


@pytest.mark.mpi
@pytest.mark.slow
def test_ranks_agree(tmp_path: Path) -> None:
    """To 1e-9 on 1, 2 and 3 ranks."""
    case = tmp_path / "case.toml"
    case.write_text(CASE)
    serial, *others = (json_on(ranks, "solve", case) for ranks in (1, 2, 3))
    for other in others:
        assert_allclose(numbers(other), numbers(serial), rtol=0, atol=1e-9)
        assert_allclose(other["dissipation"], serial["dissipation"], rtol=1e-9)
        assert max(other["checks"].values()) < 1e-8
