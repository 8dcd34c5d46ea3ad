"""A sphere in a round tube: on its axis as in the meridional plane, off it as a reflection says; no drift."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fsi
from fsi.arrays import Array
from fsi.case.load import load_case, parse_case
from fsi.errors import InputError
from fsi.lubrication import spheres
from fsi.runs import run
from fsi.stokes.model import StokesModel
from tests.ranks import json_on, needs_mpi
from tests.tube_flow import motion

MOVING = {"times": [0.0, 1.0], "values": [0.0, 1.0]}
CASE = Path(__file__).parents[2] / "cases" / "sphere_in_tube.toml"


def in_tube(tube: float, length: float, off_axis: float, **changes: Any) -> dict[str, Any]:
    """A sphere of radius 1 at half the height that is pulled up by the force 1, viscosity 1."""
    ball = {"name": "ball", "radius": 1.0, "position": [off_axis, 0.0, 0.0], "force": [0.0, 0.0, 1.0]}
    domain = {"shape": "tube", "radius": tube, "length": length}
    data = {
        "name": "t",
        "geometry": "spatial",
        "fluid": {"viscosity": 1.0},
        "domain": domain,
        "bodies": [ball],
    }
    return data | {"discretisation": {"degree": 3}} | changes


def velocity(data: dict[str, Any]) -> Array:
    case = parse_case(data)
    U: Array = StokesModel(case)(case.configuration(), 0.0).U[0]
    return U


def test_a_gap_of_two_hundredths_is_no_narrower_by_rounding() -> None:
    """1.4 - 0.686 - 0.7 is less than 0.02 * 0.7 by 1e-16."""
    data = in_tube(1.4, 4.2, 0.686)
    data["bodies"][0]["radius"] = 0.7
    assert 1.4 - 0.686 - 0.7 < 0.02 * 0.7
    parse_case(data)


def test_the_reflection_off_the_axis() -> None:
    """On the axis 1 - 2.10444 a/R + 2.08877 (a/R)^3 (Faxen; Happel and Brenner 1965, section 7-3)."""
    u, turning = motion(1.0, 20.0, 0.0)
    assert u == pytest.approx(1.0 - 2.10444 / 20.0 + 2.08877 / 20.0**3, abs=2e-5)
    assert turning == pytest.approx(0.0, abs=1e-12)


def test_a_side_that_moves_between_open_ends_carries_all_along() -> None:
    """A uniform flow, to rounding: nodes of the rims have one velocity, and all facets one side."""
    light = {"degree": 2, "cells_per_circle": 10, "cells_per_gap": 0.5, "growth": 0.8}
    data = in_tube(2.0, 6.0, 0.5, discretisation=light)
    data["bodies"][0] |= {"force": [0.0, 0.0, 0.0]}
    data["domain"] |= {"walls": {"side": [0.0, 0.0, 1.0], "top": "open", "bottom": "open"}}
    np.testing.assert_allclose(velocity(data), [0.0, 0.0, 1.0, 0.0, 0.0, 0.0], atol=1e-12)


def on_the_axis(length: float, height: float, radius: float, force: float, walls: dict[str, Any]) -> fsi.Case:
    """The same ball in a tube of radius 2, in the meridional plane; the side is the wall `right`."""
    domain = {"lower": [0.0, -0.5 * length], "upper": [2.0, 0.5 * length], "walls": walls}
    ball = {"name": "ball", "radius": radius, "position": [0.0, height], "force": [0.0, force]}
    fluid = {"viscosity": 1.0}
    return fsi.make_case(name="t", geometry="axisymmetric", fluid=fluid, domain=domain, bodies=[ball])


def test_a_side_that_moves_between_closed_ends_lets_no_fluid_through() -> None:
    """Its curved facets would let through 1e-6 of what flows; the velocity is that in the meridional plane.

    At degree 2 it misses 0.7 %.
    """
    data = in_tube(2.0, 6.0, 0.0, discretisation={"degree": 2, "cells_per_circle": 10, "growth": 0.8})
    data["bodies"][0] |= {"force": [0.0, 0.0, 0.0], "position": [0.0, 0.0, 0.7]}
    data["domain"] |= {"walls": {"side": [0.0, 0.0, 1.0]}}
    case, flat = parse_case(data), on_the_axis(6.0, 0.7, 1.0, 0.0, {"right": [0.0, 1.0]})
    found = StokesModel(case)(case.configuration(), 0.0)
    exact = StokesModel(flat)(flat.configuration(), 0.0).U[0, 1]
    assert found.checks["net_flux"] < 1e-12
    assert found.U[0, 2] == pytest.approx(exact, rel=0.015)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("length", "radius", "force", "around"),
    [(12.0, 1.0, 4.0, 16), (12.0, 1.0, 4.0, 20), (24.0, 1.0, 0.0, 16), (12.0, 0.4, 0.0, 16)],
)
def test_bars_hold_between_open_ends(length: float, radius: float, force: float, around: int) -> None:
    """Against the meridional plane, 1e-6. With rims as coarse as the side they were 1.3 to 2.9 bars off."""
    data = in_tube(2.0, length, 0.0, discretisation={"cells_per_circle": around})
    data["bodies"][0] |= {"radius": radius, "force": [0.0, 0.0, force], "position": [0.0, 0.0, 0.7]}
    walls = {"bottom": {"pressure": 20.0}, "top": "open"}
    data["domain"] |= {"walls": walls}
    found, exact = fsi.solve(parse_case(data)), fsi.solve(on_the_axis(length, 0.7, radius, force, walls))
    assert found.errors is not None
    assert abs(found.instant.U[0, 2] - exact.instant.U[0, 1]) < found.errors.U[0, 2]
    assert abs(found.dissipation - exact.dissipation) < found.errors.dissipation


@pytest.mark.slow
@pytest.mark.parametrize(
    ("walls", "flat"),
    [
        ({"side": "open"}, {"right": "open"}),
        ({"side": {"pressure": 3.0}, "top": "open"}, {"right": {"pressure": 3.0}, "top": "open"}),
        ({"side": "open", "bottom": [0.0, 0.0, 1.0]}, {"right": "open", "bottom": [0.0, 1.0]}),
        ({"bottom": {"slip_length": 0.5}, "top": "open"}, {"bottom": {"slip_length": 0.5}, "top": "open"}),
    ],
)
def test_other_walls_are_those_of_the_meridional_plane(walls: dict[str, Any], flat: dict[str, Any]) -> None:
    """Within the bars: 0.038 beside an open side, 0.009 in the closed tube."""
    data = in_tube(2.0, 6.0, 0.0, discretisation={"cells_per_circle": 12, "growth": 0.8})
    data["bodies"][0] |= {"position": [0.0, 0.0, 0.7]}
    data["domain"] |= {"walls": walls}
    found, exact = fsi.solve(parse_case(data)), fsi.solve(on_the_axis(6.0, 0.7, 1.0, 1.0, flat))
    assert found.errors is not None
    assert abs(found.instant.U[0, 2] - exact.instant.U[0, 1]) < found.errors.U[0, 2]
    assert abs(found.dissipation - exact.dissipation) < found.errors.dissipation


@pytest.mark.slow
def test_on_the_axis_it_settles_as_in_the_meridional_plane() -> None:
    """An independent mesh and solver; in a tube 1 % narrower it were 3 % slower."""
    body = {"name": "ball", "radius": 1.0, "position": [0.0, 0.0], "force": [0.0, 1.0]}
    domain = {"lower": [0.0, -6.0], "upper": [2.0, 6.0]}
    flat = {"name": "t", "geometry": "axisymmetric", "fluid": {"viscosity": 1.0}, "bodies": [body]}
    exact = velocity(flat | {"domain": domain})[1]
    fine = {"degree": 3, "cells_per_circle": 18, "growth": 0.4}
    found = velocity(in_tube(2.0, 12.0, 0.0, discretisation=fine))
    np.testing.assert_allclose(found, [0.0, 0.0, exact, 0.0, 0.0, 0.0], atol=1e-3 * exact)


@pytest.mark.slow
def test_off_the_axis_it_settles_and_turns_as_the_reflection_says() -> None:
    """Its velocity is known but for (a/R)^4 = 1e-4; on the axis it is slower by 8e-3, and does not turn.

    On meshes with 16 to 24 cells around it turns by 3.1e-3 to 3.8e-3 faster than one reflection says.
    """
    u, turning = motion(1.0, 10.0, 4.0)
    found = velocity(in_tube(10.0, 40.0, 4.0))
    assert 6.0 * np.pi * found[2] == pytest.approx(u, rel=1.5e-3)
    assert 8.0 * np.pi * found[4] == pytest.approx(turning, rel=5e-3)
    assert np.abs(found[[0, 1]]).max() < 1e-4 * found[2]


@pytest.mark.slow
def test_a_wide_tube_is_a_plane_wall() -> None:
    """At a gap of 0.1, towards the side: 225.50 and 220.71 with radii 20 and 40 go to Brenner's 216.000."""
    F = []
    for tube in (20.0, 40.0):
        data = in_tube(tube, 4.0 * tube, tube - 1.1)
        del data["bodies"][0]["force"]
        data["bodies"][0] |= {"velocity": [1.0, 0.0, 0.0], "angular_velocity": [0.0, 0.0, 0.0]}
        case = parse_case(data)
        F.append(StokesModel(case)(case.configuration(), 0.0).F[0, 0])
    # The curvature makes it larger by 0.87 a/R of it.
    assert 2.0 * F[1] - F[0] == pytest.approx(float(spheres.normal_resistance(0.1, 1.0, 1.0)), rel=1.5e-3)


@pytest.mark.slow
def test_it_does_not_drift_across(tmp_path: Path) -> None:
    """It settles by 0.76 and turns by 0.19."""
    run(load_case(CASE), tmp_path / "run")
    first, *_, last = csv.DictReader((tmp_path / "run" / "bodies.csv").read_text().splitlines())
    # The rows that the case expects; it settles at 0.19 and turns about y at 0.048.
    np.testing.assert_allclose([float(first["V_x"]), float(first["omega_x"])], 0.0, atol=1e-4)
    assert float(last["z"]) == pytest.approx(-0.7557, rel=2e-3)  # regression
    np.testing.assert_allclose([float(last["x"]) - 0.5, float(last["y"])], 0.0, atol=1e-4)
    assert float(last["angle_y"]) > 0.15
    np.testing.assert_allclose([float(last["angle_x"]), float(last["angle_z"])], 0.0, atol=1e-4)


@pytest.mark.mpi
@pytest.mark.slow
@needs_mpi
def test_ranks_agree(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(parse_case(in_tube(2.0, 6.0, 0.5, discretisation={"degree": 2})).as_toml())
    found = [np.array(json_on(ranks, "resistance", path)["resistance"]) for ranks in (1, 2, 3)]
    for other in found[1:]:
        np.testing.assert_allclose(other, found[0], atol=1e-9 * np.abs(found[0]).max())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"geometry": "planar"}, r'domain\.shape = "tube": a tube lies in space; give geometry = "spatial"'),
        (
            {"model": "reduced", "reduced": {"drag": 18.8}},
            r'model = "reduced" knows no law beside a cylinder',
        ),
        ({"walls": {"side": {"slip_length": 0.1}}}, r"domain\.walls\.side\.slip_length = 0\.1: .*; drop it"),
        (
            {"walls": {"side": [1.0, 0.0, 0.0]}},
            r"domain\.walls\.side = \[1\.0, .*\]: fluid would go through it; let",
        ),
        ({"walls": {"side": [MOVING, 0.0, 0.0]}}, r"domain\.walls\.side = .*: fluid would go through it"),
        (
            {"walls": {"side": {"shear": 1.0}}},
            r"domain\.walls\.side = \{shear = 1\.0\}: fluid would go",
        ),
        ({"walls": {"left": [0.0, 0.0, 0.0]}}, r"domain\.walls\.left = .*unknown key"),
        ({"walls": {"top": [0.0, 0.0, 1.0]}}, r"domain\.walls\.top = .*net flux"),
        ({"length": 0.0}, r"domain\.length = 0\.0"),
        ({"radius": 1.4}, r"'ball' touches or crosses wall 'side' \(gap -0\.1\)"),
        (
            {"radius": 1.5199},
            r"bodies\.0\.position = \[0\.5, .*: the gap of 'ball' to wall 'side' is 0\.0199, below 0\.02 of "
            "the radius, 1; widen it",
        ),
        ({"body": {"radius": None, "shape": {"kind": "ellipsoid", "axes": [0.5, 0.5, 0.7]}}}, "spheres only"),
    ],
)
def test_what_a_tube_does_not_know_is_refused_by_name(changes: dict[str, Any], message: str) -> None:
    data = in_tube(2.0, 6.0, 0.5)
    ball, domain = dict(data["bodies"][0]), dict(data["domain"])
    for key, value in changes.items():
        if key == "body":
            ball = {k: v for k, v in (ball | value).items() if v is not None}
        elif key in ("walls", "length", "radius"):
            domain[key] = value
        else:
            data[key] = value
    if changes.get("geometry") == "planar":
        ball |= {"position": [0.5, 0.0], "force": [0.0, 1.0]}
    with pytest.raises(InputError, match=message):
        parse_case(data | {"bodies": [ball], "domain": domain})
