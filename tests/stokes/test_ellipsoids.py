"""Flow around ellipsoids in space: against Oberbeck and Jeffery, spheres, and itself moved and turned."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy  # its modules load when they are used

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.lubrication.ellipsoids import (
    free_rotation,
    in_far_ball,
    rotation_resistance,
    translation_resistance,
)
from fsi.observables.quantities import computed
from fsi.stokes.model import StokesModel
from fsi.validation.rows import reference
from tests.stokes.moved_meshes import gives_what_a_new_one_does

CASES = Path(__file__).parents[2] / "cases"
COARSE = {"degree": 2, "cells_per_circle": 10, "growth": 0.8}
BALL = 40.0
SHEAR = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])  # u = z e_x


def in_ball(axes: tuple[float, ...], angle: tuple[float, ...] = (0.0, 0.0, 0.0), **sections: Any) -> Case:
    """A free ellipsoid at the centre of a ball that stands for infinity, whose wall shears it."""
    shape = {"kind": "ellipsoid", "axes": list(axes)}
    return parse_case(
        {
            "name": "ellipsoid",
            "geometry": "spatial",
            "fluid": {"viscosity": 1.0},
            "domain": {"shape": "round", "radius": BALL, "walls": {"far": {"shear": 1.0}}},
            "bodies": [{"name": "body", "shape": shape, "angle": list(angle), "position": [0.0, 0.0, 0.0]}],
        }
        | sections
    )


def rotation_by_jeffery(axes: tuple[float, ...], angle: tuple[float, ...]) -> Array:
    own = scipy.spatial.transform.Rotation.from_rotvec(angle).as_matrix()
    omega: Array = own @ free_rotation(np.array(axes), own.T @ SHEAR @ own)
    return omega


def test_an_ellipsoid_turns_as_jeffery_says_on_a_coarse_mesh() -> None:
    """To 3 %; the same turning the other way, or with two axes exchanged, is off by 40 % or more."""
    axes, angle = (1.0, 0.7, 0.5), (0.3, 0.2, 1.0)
    case = in_ball(axes, angle, discretisation=COARSE)
    solution = StokesModel(case)(case.configuration(), 0.0)
    exact = rotation_by_jeffery(axes, angle)
    np.testing.assert_allclose(solution.U[0, 3:], exact, atol=0.03 * np.linalg.norm(exact))
    assert max(solution.checks.values()) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("angle", [(0.0, 0.0, 0.0), (0.0, 0.7, 0.0), (0.3, 0.2, 1.0)])
def test_an_ellipsoid_turns_as_jeffery_says(angle: tuple[float, ...]) -> None:
    axes = (1.0, 0.7, 0.5)
    case = in_ball(axes, angle, discretisation={"cells_per_circle": 20})
    omega = StokesModel(case)(case.configuration(), 0.0).U[0, 3:]
    exact = rotation_by_jeffery(axes, angle)
    np.testing.assert_allclose(omega, exact, atol=2e-3 * np.linalg.norm(exact))


@pytest.mark.slow
def test_the_period_of_a_free_spheroid_in_shear() -> None:
    """2 pi (r + 1/r) = int dtheta / omega, r = 2, by the trapezoidal rule, which errs by 2 3^-8 here."""
    angles, axes = 8, (1.0, 0.5, 0.5)
    theta = np.pi * np.arange(angles // 2 + 1) / angles  # omega(-theta) = omega(theta)
    omega = []
    for angle in theta.tolist():
        case = in_ball(axes, (0.0, angle, 0.0), discretisation={"cells_per_circle": 20})
        omega.append(StokesModel(case)(case.configuration(), 0.0).U[0, 4])
    weight = np.full(len(theta), 2.0)
    weight[[0, -1]] = 1.0
    period = 2.0 * np.pi / angles * float(np.sum(weight / np.array(omega)))
    assert period == pytest.approx(5.0 * np.pi, rel=2e-3)


@pytest.mark.slow
def test_the_six_resistances_of_an_ellipsoid() -> None:
    case = load_case(CASES / "validation" / "ellipsoid.toml")
    solution = StokesModel(case)(case.configuration(), 0.0)
    for row in case.expected:
        assert computed(case, solution, row.quantity) == pytest.approx(reference(case, row)[0], rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("axes", [(1.0, 0.5, 0.5), (1.0, 1.0, 0.5), (1.0, 0.2, 0.2), (1.0, 1.0, 0.2)])
def test_spheroids_along_across_and_turning(axes: tuple[float, float, float]) -> None:
    """Prolate and oblate of ratio 2 and 5, all six to 2e-3; the ball alone changes drags by some 4 %."""
    moving = {"velocity": [1.0] * 3, "angular_velocity": [1.0] * 3, "position": [0.0] * 3}
    body = {"name": "body", "shape": {"kind": "ellipsoid", "axes": list(axes)}} | moving
    case = in_ball(axes, domain={"shape": "round", "radius": BALL}, bodies=[body])
    F = StokesModel(case)(case.configuration(), 0.0).F[0]
    along = [in_far_ball(R, BALL, 1.0) for R in translation_resistance(np.array(axes), 1.0)]
    exact = np.array([*along, *rotation_resistance(np.array(axes), 1.0)])
    np.testing.assert_allclose(F, exact, rtol=2e-3)


def in_box(body: dict[str, Any], **sections: Any) -> Case:
    """A body that is held turning above the floor of a box."""
    held = {"name": "body", "position": [0.0, 0.0, -1.0], "velocity": [0.3, 0.0, -1.0]} | body
    return parse_case(
        {
            "name": "in a box",
            "geometry": "spatial",
            "fluid": {"viscosity": 1.0},
            "domain": {"lower": [-3.0] * 3, "upper": [3.0] * 3},
            "bodies": [held],
            "discretisation": COARSE,
        }
        | sections
    )


@pytest.mark.slow
@pytest.mark.parametrize("slip", [0.0, 0.3])
def test_an_ellipsoid_of_equal_axes_is_a_sphere(slip: float) -> None:
    """On other meshes, so to their errors of some 1e-3; slip takes a third of the drag."""
    shape = {"kind": "ellipsoid", "axes": [1.0, 1.0, 1.0]}
    cases = [in_box(body | {"slip_length": slip}) for body in ({"radius": 1.0}, {"shape": shape})]
    sphere, ellipsoid = (StokesModel(case)(case.configuration(), 0.0) for case in cases)
    np.testing.assert_allclose(ellipsoid.F, sphere.F, atol=5e-3 * np.abs(sphere.F).max())
    assert max(ellipsoid.checks.values()) < 1e-8


@pytest.mark.slow
def test_a_moved_and_turned_mesh_gives_what_a_new_one_does() -> None:
    body = {"shape": {"kind": "ellipsoid", "axes": [1.2, 0.6, 0.8]}, "angle": [0.2, 0.1, 0.0]}
    way = np.array([[0.0, 0.0, -0.2, 0.0, 0.2, 0.1]])
    gives_what_a_new_one_does(in_box(body), way, changes=3e-2, tolerance=3e-3)
