"""Resolved forces against exact solutions, truncation of the half-plane included."""

import json
from pathlib import Path
from typing import Any

import pytest

from fsi.lubrication import exact
from fsi.meshes.geometry.box import Box
from fsi.meshes.resolution import Resolution
from fsi.stokes.problem import Boundary
from tests.flows import BOX, HALF_PLANE, at_rest, disc_over_plane, discs, free, held, shear, solved

REFERENCE = Path(__file__).parents[1] / "reference"
RTOL = 1e-4
GAPS = [1.0, 0.1, 1e-2, 1e-3, 1e-4]


def reference(name: str) -> Any:
    return json.loads((REFERENCE / name).read_text())


def box_forces(resolution: Resolution, degree: int) -> dict[str, float]:
    """The four values of disc_in_box.json, named and signed as there."""
    q = disc_over_plane(0.1)
    normal, along, turning = (
        solved(BOX, q, held(U), resolution=resolution, degree=degree).F[0]
        for U in ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    )
    # The reference's coupling is the force of the body ON the fluid, which is F.
    return {
        "F_normal": -normal[1],
        "F_tangential": along[0],
        "T_rotation": turning[2],
        "coupling": turning[0],
    }


def test_disc_in_a_box_at_the_default_resolution() -> None:
    """Two high-order codes, to 1e-8. A shift of the disc by 1e-5 changes the normal force by 1.5e-4."""
    expected = reference("disc_in_box.json")["rows"][0]
    for name, value in box_forces(Resolution(), 3).items():
        assert value == pytest.approx(expected[name], rel=RTOL), name


def test_disc_in_a_box_at_a_fine_resolution() -> None:
    """To 1e-7 of each value, plus half a unit of the last digit that the reference prints."""
    expected = reference("disc_in_box.json")["rows"][0]
    last_digit = {"F_normal": 5e-6, "F_tangential": 5e-6, "T_rotation": 5e-7, "coupling": 5e-7}
    for name, value in box_forces(Resolution(3.0, 80, 0.1), 4).items():
        assert abs(value - expected[name]) <= 1e-7 * abs(expected[name]) + last_digit[name], name


@pytest.mark.parametrize("gap", GAPS)
def test_disc_beside_a_plane(gap: float) -> None:
    """Jeffrey and Onishi 1981. The leading normal force alone is 1 % off at gap 0.01, 65 % at 1."""
    q = disc_over_plane(gap)
    rest = Boundary({"plane": at_rest, "far": at_rest}, {})
    towards = solved(HALF_PLANE, q, held((0.0, -1.0, 0.0)), rest).F[0]
    along = solved(HALF_PLANE, q, held((1.0, 0.0, 0.0)), rest).F[0]
    turning = solved(HALF_PLANE, q, held((0.0, 0.0, 1.0)), rest).F[0]
    assert -towards[1] == pytest.approx(exact.normal_resistance(gap, 1.0, 1.0), rel=RTOL)
    assert along[0] == pytest.approx(exact.parallel_resistance(gap, 1.0, 1.0), rel=RTOL)
    assert turning[2] == pytest.approx(exact.rotation_resistance(gap, 1.0, 1.0), rel=RTOL)
    # Couplings vanish for a cylinder: zero torque along, zero force when turning.
    assert abs(along[2]) < RTOL * along[0]
    assert abs(turning[0]) < RTOL * turning[2]


@pytest.mark.parametrize("gap", GAPS)
def test_free_disc_in_shear(gap: float) -> None:
    """U = gamma a sinh al, omega = -(gamma / 2) tanh al (clockwise); a disc held in x would give U = 0."""
    boundary = Boundary({"plane": at_rest, "far": shear}, {})
    U = solved(HALF_PLANE, disc_over_plane(gap), free((0.0, 0.0, 0.0)), boundary).U[0]
    velocity, omega = exact.free_in_shear(gap, 1.0, 1.0)
    assert U[0] == pytest.approx(velocity, rel=RTOL)
    assert U[2] == pytest.approx(omega, rel=RTOL)
    assert abs(U[1]) < RTOL * abs(U[0])


@pytest.mark.parametrize("gap", [1.0, 0.1, 1e-2, 1e-3])
def test_two_equal_discs_approaching(gap: float) -> None:
    """Bipolar closed form in the whole plane; the pair exerts no force: a far box changes it by (a / R)^2."""
    far = Box((-1000.0, -1000.0), (1000.0, 1000.0))
    q = discs([(-1.0 - gap / 2, 0.0), (1.0 + gap / 2, 0.0)], [1.0, 1.0])
    F = solved(far, q, held((0.5, 0.0, 0.0), (-0.5, 0.0, 0.0))).F
    expected = exact.pair_resistance(gap, 1.0, 1.0)
    assert F[0, 0] == pytest.approx(expected, rel=RTOL)
    assert F[1, 0] == pytest.approx(-expected, rel=RTOL)
