"""Numbers so small or large that what is computed of them is none are refused by their key."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest

from fsi.case.load import parse_case
from fsi.errors import InputError
from tests.case_data import BOX, changed

SPATIAL: dict[str, Any] = {
    "name": "ball",
    "geometry": "spatial",
    "fluid": {"viscosity": 1.0},
    "domain": {"lower": [-4.0] * 3, "upper": [4.0] * 3},
    "bodies": [
        {"name": "ball", "position": [0.0] * 3, "shape": {"kind": "ellipsoid", "axes": [2.0, 1.0, 1.0]}}
    ],
}
SAID = "too small or too large for numbers, 1e-50 to 1e+50 in size; give other units"


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("domain", {"shape": "round", "radius": 1e160}),  # its volume raised OverflowError
        ("domain.walls.top", [1e155, 0.0]),
        ("domain.walls.right", {"pressure": 1e-200}),
        ("fluid.viscosity", 1e-200),
        ("fluid.viscosity", 10**60),
        ("bodies.1.radius", 8e159),
        ("bodies.1.radius", 1e-60),
        ("bodies.1.position", [1e160, 0.0]),  # the tree of neighbours overflows
        ("bodies.0.force", [1e155, 0.0]),
        ("bodies.0.force", [0.0, -1e-200]),  # `net_flux` had no digits left
        ("bodies.0.torque", {"times": [0.0, 1.0], "values": [0.0, -1e200]}),
        ("bodies.0.velocity", ["free", 1e200]),
    ],
)
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("model", ["resolved", "gluey"])
def test_what_is_too_small_or_too_large_is_refused(key: str, value: Any, model: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_case(changed(key, value) | {"model": model})
    assert str(caught.value).startswith(key)
    assert str(caught.value).endswith(SAID)


def test_bodies_of_a_file_and_of_grids(tmp_path: Path) -> None:
    file = tmp_path / "bodies.csv"
    file.write_text("name,radius,x,y\nfar,1.0,1e160,0.0\n")
    data = {key: value for key, value in BOX.items() if key != "bodies"}
    with pytest.raises(InputError, match=r"^bodies\.0\.position = \[1e\+160, 0\.0\]: too small or too large"):
        parse_case(data | {"bodies_from": str(file)})
    grid = {"name": "g", "counts": [2, 2], "lower": [0.0, 1.0], "spacing": 1e200, "radius": [1.0, 1.0]}
    with pytest.raises(InputError, match=r"^grids\.0\.spacing = 1e\+200: too small or too large"):
        parse_case(data | {"model": "gluey", "grids": [grid]})


def test_what_has_no_size_may_be_small() -> None:
    """A place near the origin, a turn, one component of several, and zero."""
    data = copy.deepcopy(BOX)
    data["bodies"][0] |= {"position": [1e-200, 1.1], "angle": 1e-200, "force": [1.0, 1e-200]}
    data["bodies"][1] |= {"force": [0.0, 0.0], "torque": 0.0}
    assert parse_case(data).bodies[0].force == (1.0, 1e-200)


def test_the_bounds_belong_to_what_is_taken() -> None:
    data = changed("fluid.viscosity", 1e-50)
    data["bodies"][0]["force"] = [1e50, 0.0]
    assert parse_case(data).bodies[0].force == (1e50, 0.0)


def test_a_key_where_none_is_known_is_to_be_dropped() -> None:
    """The line ended in "use  or drop it"."""
    data = changed("domain", {"shape": "unbounded", "walls": {"top": {"pressure": 1.0}}}) | {"model": "gluey"}
    with pytest.raises(InputError) as caught:
        parse_case(data)
    assert str(caught.value) == "domain.walls.top = {pressure = 1.0}: unknown key; drop it"


@pytest.mark.parametrize("upper", [[1e15, 16.0], [8.0, 1e15]])
def test_a_gap_that_large_coordinates_do_not_tell_is_no_touch(upper: list[float]) -> None:
    """0.1 beside a wall, rounded to 8 eps 1e15; the disc was said to cross it and to be moved."""
    with pytest.raises(
        InputError, match=r"'disc' and wall 'bottom' \(gap 0\.1\): .* rounded to gaps of 1\.8;"
    ):
        parse_case(changed("domain.upper", upper))
    parse_case(changed("domain.upper", [1e12, 16.0]))


@pytest.mark.parametrize(
    ("angle", "case"),
    [
        (1e200, BOX),  # an orientation by chance
        ([0.0, -1e160, 0.0], SPATIAL),  # its norm overflows: ValueError
    ],
)
def test_an_angle_that_tells_no_direction_is_refused(angle: Any, case: dict[str, Any]) -> None:
    """Of 2^k <= angle < 2^(k + 1) the neighbours are 2^(k - 52) away, 1.5e-8 at 1e8."""
    data = copy.deepcopy(case)
    data["bodies"][0]["angle"] = angle
    with pytest.raises(
        InputError, match=r"^bodies\.0\.angle = .*1e\+.*: is rounded .*beyond 1e\+08 .*; give it w"
    ):
        parse_case(data)
    data["bodies"][0]["angle"] = [0.0, -1e8, 0.0] if case is SPATIAL else 1e8
    parse_case(data)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("macroscopic", {"parcels": 10**400}),  # OverflowError, as each of these
        ("discretisation", {"cells_per_circle": -(2**63) - 1}),
        ("discretisation", {"cells_per_circle": 10**5000}),  # and Python writes no number of so many digits
        ("arrangement", {"number": 2**63, "kind": "square", "area_fraction": 0.4}),
        ("grids", [{"counts": [2, 2**63]}]),
        ("time", {"end": 10**20}),
    ],
)
def test_whole_numbers_have_64_bits(key: str, value: Any) -> None:
    with pytest.raises(InputError) as caught:
        parse_case(changed(key, value))
    assert str(caught.value).startswith(f"{key}.")
    assert str(caught.value).endswith(": a whole number has more than 64 bits; give a smaller one")
    assert len(str(caught.value)) < 200


def test_a_jitter_of_minus_zero_is_none() -> None:
    """NumPy said "high - low < 0"."""
    grid = {"name": "g", "counts": [2, 2], "lower": [-6.0, 6.0], "spacing": 3.0, "radius": [1.0, 1.0]}
    still, minus = (parse_case(changed("grids", [grid | {"jitter": x}])) for x in (0.0, -0.0))
    assert still == minus
