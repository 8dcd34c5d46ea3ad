"""Exact results are refused in cases whose bodies look, stand or move as their formulas do not know them."""

from typing import Any

import pytest

from fsi.case.checks.expected import check_expected
from fsi.case.load import parse_case
from fsi.errors import InputError

KINDS: dict[str, tuple[str, dict[str, Any], str]] = {
    "concentric_sphere": ("axisymmetric", {"velocity": [0.0, 1.0]}, "force.z"),
    "sliding_sphere": ("axisymmetric", {"velocity": [0.0, 1.0]}, "force.z"),
    "spheroid": ("axisymmetric", {"velocity": [0.0, 1.0]}, "force.z"),
    "swimming_sphere": ("axisymmetric", {"surface_velocity": [1.0]}, "velocity.z"),
    "sliding_disc": ("planar", {"velocity": [1.0, 0.0]}, "force.x"),
    "swimming_disc": ("planar", {"surface_velocity": [1.0]}, "velocity.x"),
    "ellipsoid": ("spatial", {"velocity": [1.0, 0.0, 0.0]}, "force.x"),
    "ellipsoid_in_shear": ("spatial", {}, "angular_velocity.y"),
}


def row(quantity: str, exact: str) -> dict[str, Any]:
    return {"quantity": quantity, "exact": exact, "rtol": 1e-3, "source": "the test"}


def lone(exact: str, **changes: Any) -> dict[str, Any]:
    """A body at the centre of a round container."""
    geometry, motion, quantity = KINDS[exact]
    centre = [0.0] * (3 if geometry == "spatial" else 2)
    far = {"walls": {"far": {"shear": 1.0}}} if "shear" in exact else {}
    return {
        "name": "lone", "geometry": geometry, "fluid": {"viscosity": 1.0},
        "domain": {"shape": "round", "radius": 9.0} | far,
        "bodies": [{"name": "a", "radius": 1.0, "position": centre} | motion | changes],
        "expected": [row(f"a.{quantity}", exact)],
    }  # fmt: skip


@pytest.mark.parametrize("exact", KINDS)
def test_a_body_off_the_centre_is_refused(exact: str) -> None:
    """Formulas of concentric bodies: off the centre other numbers hold."""
    data = lone(exact)
    check_expected(parse_case(data))
    data["bodies"][0]["position"][-1] = 1e-3
    with pytest.raises(InputError, match=rf'"{exact}": is for a body at the centre .*bodies\.0\.position = '):
        check_expected(parse_case(data))


def test_a_shape_is_no_disc() -> None:
    """Its `radius` is that of the circle around it, which no formula of discs means."""
    data = lone("sliding_disc", shape={"kind": "ellipse", "axes": [1.0, 0.5]})
    del data["bodies"][0]["radius"]
    with pytest.raises(InputError, match=r"is for round bodies; give bodies\.0\.radius and no shape"):
        check_expected(parse_case(data))


@pytest.mark.parametrize(("exact", "angle"), [("swimming_disc", 0.5), ("swimming_sphere", 3.14159265)])
def test_a_turned_swimmer_goes_elsewhere(exact: str, angle: float) -> None:
    with pytest.raises(InputError, match=rf'"{exact}": is for swimmers that are not turned'):
        check_expected(parse_case(lone(exact, angle=angle)))


def pair(quantity: str, *, off: float = 0.0, radius: float = 1.0, velocity: Any = -1.0) -> dict[str, Any]:
    """Two discs on the x axis that meet in a round container, the second one perhaps otherwise."""
    first = {"name": "a", "radius": 1.0, "position": [-1.5, 0.0], "velocity": [1.0, 0.0]}
    second = {"name": "b", "radius": radius, "position": [1.5, off], "velocity": [velocity, 0.0]}
    return {
        "name": "pair", "fluid": {"viscosity": 1.0}, "domain": {"shape": "round", "radius": 200.0},
        "bodies": [first, second], "expected": [row(quantity, "two_discs")],
    }  # fmt: skip


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (pair("a.force.x", off=1.0), r"line of centres .* change bodies\.1\.position"),
        (pair("a.force.y"), "line of centres .* or the quantity"),
        (pair("a.torque"), "line of centres .* or the quantity"),
        (pair("a.force.x", radius=0.25), r"equal discs; give bodies\.1\.radius = 1\.0"),
        (pair("a.force.x", velocity=0.0), r"opposite velocities; give bodies\.1\.velocity\.0"),
        (pair("a.force.x", velocity="free"), r"opposite velocities; give bodies\.1\.velocity\.0"),
    ],
)
def test_two_discs_are_equal_and_meet_along_an_axis(data: dict[str, Any], said: str) -> None:
    """Otherwise a net force or another direction counts, which the formula does not have."""
    check_expected(parse_case(pair("a.force.x")))
    with pytest.raises(InputError, match=f'"two_discs": is for .*{said}'):
        check_expected(parse_case(data))
