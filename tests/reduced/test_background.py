"""The flow without bodies that the walls of a reduced case drive, and open walls."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.errors import InputError
from fsi.models import make_model
from tests.reduced_data import reduced_case

BOX: dict[str, Any] = {"lower": [-8.0, -8.0], "upper": [8.0, 8.0]}
SHIFT = [0.3, 0.7]


def case_in(domain: dict[str, Any], place: list[float], cutoff: float = 0.5, **more: Any) -> Case:
    bodies = [{"name": "one", "radius": 1.0, "position": place, **more}]
    geometry = "planar" if len(place) == 2 else "spatial"
    return reduced_case(bodies, {"drag": 12.0, "cutoff": cutoff}, domain=domain, geometry=geometry)


def velocities(case: Case) -> Array:
    return np.asarray(make_model(case)(case.configuration(), 0.0).U)


@pytest.mark.parametrize(
    "domain",
    [
        BOX | {"walls": dict.fromkeys(("left", "right", "bottom", "top"), SHIFT)},
        BOX | {"walls": {"left": SHIFT, "right": "open", "bottom": SHIFT, "top": "open"}},
        {"shape": "round", "radius": 50.0, "walls": {"far": SHIFT}},
        {"shape": "half-plane", "radius": 50.0, "walls": {"plane": SHIFT, "far": SHIFT}},
    ],
)
def test_where_all_walls_move_alike_a_body_moves_with_them(domain: dict[str, Any]) -> None:
    """Galilean invariance: far from all of them, and as near to one as lubrication reaches."""
    for height in (4.0, 1.1):
        assert velocities(case_in(domain, [0.0, height])) == pytest.approx(
            np.array([[*SHIFT, 0.0]]), abs=1e-14
        )


def test_a_flow_between_side_walls_is_one_between_bottom_and_top_turned() -> None:
    """By a right angle: u_y = x/8 where it was u_x = -y/8, of the same rotation."""
    lying = velocities(case_in(BOX | {"walls": {"bottom": [1.0, 0.0], "top": [-1.0, 0.0]}}, [0.0, 3.0]))
    standing = velocities(case_in(BOX | {"walls": {"left": [0.0, -1.0], "right": [0.0, 1.0]}}, [3.0, 0.0]))
    assert lying == pytest.approx(np.array([[-3.0 / 8.0, 0.0, 1.0 / 16.0]]), rel=1e-14)
    assert standing == pytest.approx(np.array([[0.0, 3.0 / 8.0, 1.0 / 16.0]]), rel=1e-14)


def test_in_space_a_wall_drives_a_flow_along_both_its_directions() -> None:
    """u = (3, -5, 0) (z + 8)/16, whose rotation is half the curl, (5, 3, 0)/32."""
    walls = {"top": [3.0, -5.0, 0.0]}
    case = case_in({"lower": [-8.0] * 3, "upper": [8.0] * 3, "walls": walls}, [0.0, 0.0, 4.0])
    expected = [[9.0 / 4.0, -15.0 / 4.0, 0.0, 5.0 / 32.0, 3.0 / 32.0, 0.0]]
    assert velocities(case) == pytest.approx(np.array(expected), rel=1e-14)


@pytest.mark.parametrize("x", [0.0, -6.9])
def test_the_shear_flow_given_at_all_walls_of_a_box_is_the_background(x: float) -> None:
    """Beside a wall through which it flows, too: there fluid moves as the disc does."""
    walls = {wall: {"shear": 0.5} for wall in ("left", "right", "bottom", "top")}
    assert velocities(case_in(BOX | {"walls": walls}, [x, 3.0])) == pytest.approx(
        np.array([[1.5, 0.0, -0.25]]), rel=1e-14
    )


@pytest.mark.parametrize("height", [3.0, -6.9, 6.9])
def test_walls_that_a_shear_flow_moves_are_walls_that_move(height: float) -> None:
    """At y = -8 and 8 with u_x = y/2, which a body a tenth of its radius away feels by laws of sliding."""
    laws = {"drag": 12.0, "cutoff": 0.5, "law": "exact", "shear_law": "exact", "rotation_law": "exact"}
    bodies = [{"name": "one", "radius": 1.0, "position": [0.0, height]}]
    sheared, moved = (
        velocities(reduced_case(bodies, laws, domain=BOX | {"walls": walls}))
        for walls in (
            {wall: {"shear": 0.5} for wall in ("left", "right", "bottom", "top")},
            {"bottom": [-4.0, 0.0], "top": [4.0, 0.0]},
        )
    )
    assert sheared == pytest.approx(moved, rel=1e-14)


def test_an_open_wall_lubricates_nothing() -> None:
    """Pushed towards an opening, 1e-2 from it, a body moves as if there were none: F / drag."""
    case = case_in(BOX | {"walls": {"right": "open"}}, [6.99, 0.0], force=[6.0, 0.0])
    assert velocities(case) == pytest.approx(np.array([[0.5, 0.0, 0.0]]), rel=1e-14)


@pytest.mark.parametrize(
    ("domain", "message"),
    [
        (BOX | {"walls": {"left": {"pressure": 10.0}, "right": "open"}}, "pressure drives"),
        (BOX | {"walls": {"top": [1.0, 0.0], "left": [0.0, 1.0]}}, "drives a flow"),
        (BOX | {"walls": {"bottom": [0.0, 1.0], "top": [0.0, 1.0]}}, "drives a flow"),
        ({"shape": "half-plane", "radius": 50.0, "walls": {"plane": [1.0, 0.0]}}, "drives a flow"),
    ],
)
def test_other_flows_are_refused(domain: dict[str, Any], message: str) -> None:
    """They were left out without a word."""
    with pytest.raises(InputError, match=message):
        case_in(domain, [0.0, 4.0])
