"""Resolved flows beside walls with a shape: against lubrication, plane walls, and the same walls turned."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import fsi
from fsi.case.load import parse_case

WAVE = {"kind": "wave", "height": 0.3, "length": 1.5, "number": 3, "start": -2.0}
COARSE = {"degree": 3, "cells_per_circle": 24, "growth": 0.4}


def solved(
    lower: list[float], upper: list[float], body: dict[str, Any], domain: dict[str, Any], **sections: Any
) -> fsi.Solution:
    data = {"name": "wavy", "fluid": {"viscosity": 1.0}, "discretisation": COARSE} | sections
    data |= {"domain": {"lower": lower, "upper": upper} | domain}
    held = {"name": "disc", "radius": 1.0, "angular_velocity": 0.2}
    return fsi.solve(parse_case(data | {"bodies": [held | body]}))


@pytest.mark.slow
def test_a_box_that_is_turned_has_the_same_loads() -> None:
    """By a quarter, (x, y) -> (-y, x), and by half: bottom becomes right and top. Meshes differ, so that
    loads do by their errors, 2e-5 of the largest; places taken the other way along a wall change them by a
    tenth."""
    body = {"position": [0.2, 1.4], "velocity": [0.3, -1.0]}
    first = solved([-4.0, 0.0], [4.0, 6.0], body, {"profiles": {"bottom": WAVE}})["disc"]
    body = {"position": [-1.4, 0.2], "velocity": [1.0, 0.3]}
    quarter = solved([-6.0, -4.0], [0.0, 4.0], body, {"profiles": {"right": WAVE}})["disc"]
    body = {"position": [-0.2, -1.4], "velocity": [-0.3, 1.0]}
    back = WAVE | {"start": -2.5}
    half = solved([-4.0, -6.0], [4.0, 0.0], body, {"profiles": {"top": back}})["disc"]
    scale = 2e-5 * float(np.abs(first.force).max())
    np.testing.assert_allclose([quarter.force[1], -quarter.force[0]], first.force, atol=scale)
    np.testing.assert_allclose(-half.force, first.force, atol=scale)
    np.testing.assert_allclose([quarter.torque, half.torque], first.torque, atol=scale)


def test_a_wave_without_height_is_a_plane_wall() -> None:
    """To the errors of both meshes."""
    body = {"position": [0.2, 1.4], "velocity": [0.3, -1.0]}
    flat = {"profiles": {"bottom": WAVE | {"height": 0.0}}}
    wavy, plane = (solved([-4.0, 0.0], [4.0, 6.0], body, domain)["disc"] for domain in (flat, {}))
    np.testing.assert_allclose(wavy.force, plane.force, rtol=2e-5)


@pytest.mark.parametrize("place", ["crest", pytest.param("trough", marks=pytest.mark.slow)])
def test_the_film_over_a_wave_has_its_curvature(place: str) -> None:
    """F = 3 sqrt(2) pi mu U / (kappa q)^(3/2), kappa the sum of both curvatures (Jeffrey and Onishi 1981 for
    a plane). With kappa of the disc alone it would be 1.8 times as large or 0.3 of it."""
    height, length, q = 0.02, 1.5, 1e-5
    bent = 0.5 * height * (2.0 * np.pi / length) ** 2
    kappa = 1.0 + (bent if place == "crest" else -bent)
    wave = WAVE | {"height": height, "start": -2.25 if place == "crest" else -1.5}
    y = 1.0 + q + (height if place == "crest" else 0.0)
    body = {"position": [0.0, y], "velocity": [0.0, -1.0], "angular_velocity": 0.0}
    found = solved([-4.0, 0.0], [4.0, 6.0], body, {"profiles": {"bottom": wave}}, discretisation={})
    exact = 3.0 * np.sqrt(2.0) * np.pi / (kappa * q) ** 1.5
    assert found["disc"].force[1] == pytest.approx(exact, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("sliding", [["bottom"], ["bottom", "left", "right"], ["bottom", "top"]])
def test_fluid_slides_along_a_wavy_wall(sliding: list[str]) -> None:
    """Powers balance with the slip's part, no fluid goes through, and half the cells give the same force."""
    body = {"position": [0.2, 1.4], "velocity": [0.3, -1.0]}
    walls = {"walls": {wall: {"slip_length": 0.1} for wall in sliding}, "profiles": {"bottom": WAVE}}
    found = solved([-4.0, 0.0], [4.0, 6.0], body, walls)
    checks = getattr(found.instant, "checks")  # noqa: B009  (of a flow)
    assert checks["power"] < 1e-8
    assert checks["net_flux"] < 1e-10
    assert found.instant.record["slip_dissipation"] > 0.0
    finer = solved([-4.0, 0.0], [4.0, 6.0], body, walls, discretisation={})
    np.testing.assert_allclose(found["disc"].force, finer["disc"].force, rtol=2e-5)
    stuck = solved([-4.0, 0.0], [4.0, 6.0], body, {"profiles": {"bottom": WAVE}})
    assert found["disc"].force[1] < 0.9 * stuck["disc"].force[1]
