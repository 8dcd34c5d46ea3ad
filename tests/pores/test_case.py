"""Cases of the model of pores: what they may ask for, and the one line that each mistake gives."""

import copy
from typing import Any

import pytest

from fsi.case.checks.work import check_work
from fsi.case.load import parse_case
from fsi.errors import InputError

CHANNEL: dict[str, Any] = {
    "name": "test",
    "model": "pores",
    "fluid": {"viscosity": 1.0},
    "domain": {
        "lower": [0.0, 0.0],
        "upper": [8.0, 6.0],
        "periodic": ["x"],
        "walls": {"bottom": [-1.0, 0.0], "top": [1.0, 0.0]},
    },
    "bodies": [
        {"name": "one", "radius": 1.0, "position": [2.0, 2.0]},
        {"name": "other", "radius": 0.5, "position": [5.0, 4.0]},
    ],
}
CELL = {"shape": "cell", "vectors": [[8.0, 0.0], [1.0, 6.0]], "shear": 1.0}
BOX = {"lower": [0.0, 0.0], "upper": [8.0, 6.0]}
SLIDING = {"times": [0.0, 1.0], "values": [0.0, 1.0]}


def changed(**sections: Any) -> dict[str, Any]:
    return copy.deepcopy(CHANNEL) | sections


@pytest.mark.parametrize(
    "domain",
    [
        CHANNEL["domain"],
        CELL,
        CELL | {"shear": 0.0, "extension": 1.0},
        BOX,
        CHANNEL["domain"] | {"walls": {"top": [SLIDING, 0.0]}, "pressure_gradient": -1.0},
        CHANNEL["domain"] | {"net_flux": 2.0},
    ],
)
def test_it_takes_channels_cells_and_boxes(domain: dict[str, Any]) -> None:
    assert parse_case(changed(domain=domain)).level.flow


def test_it_takes_round_containers() -> None:
    bodies = [{"name": "one", "radius": 1.0, "position": [0.5, 0.0]}]
    assert parse_case(changed(domain={"shape": "round", "radius": 3.0}, bodies=bodies)).level.flow


BAD = [
    ({"pores": {"modes": 3}}, ["pores.modes = 3", "0, 1, 2, 4, 6, 8, 10, 12 or 16"]),
    ({"pores": {"modes": 1.5}}, ["pores.modes = 1.5", "0, 1, 2, 4, 6, 8, 10, 12 or 16"]),
    ({"pores": {"tolerance": 0.0}}, ["pores.tolerance = 0.0", "in (0, 1)"]),
    ({"pores": {"mode": 1}}, ["use pores.modes"]),
    ({"bodies": []}, ["bodies: missing", "add [[bodies]]"]),
    ({"geometry": "spatial", "domain": BOX | {"lower": 3 * [0.0], "upper": 3 * [9.0]}, "bodies": []},
     ['geometry = "spatial"', 'give "planar"']),
    ({"geometry": "axisymmetric", "domain": BOX, "bodies": []}, ['geometry = "axisymmetric"', "resolved"]),
    ({"domain": {"shape": "half-plane", "radius": 50.0}}, ['domain.shape = "half-plane"', 'give "box"']),
    ({"domain": BOX | {"walls": {"top": "open"}}}, ["domain.walls.top", '"open"', "no open walls"]),
    ({"domain": BOX | {"walls": {"top": {"pressure": 1.0}}}}, ["domain.walls.top", "no open walls"]),
    ({"domain": BOX | {"walls": {"top": [1.0, 0.0]}}},
     ["domain.walls.top = [1.0, 0.0]", "only walls of a channel slide", "resolved"]),
    ({"domain": CHANNEL["domain"] | {"walls": {"top": {"shear": 1.0}}}}, ["domain.walls.top", "[u_x, 0.0]"]),
    ({"domain": CHANNEL["domain"] | {"walls": {"top": [0.0, 1.0], "bottom": [0.0, 1.0]}}},
     ["domain.walls.bottom = [0.0, 1.0]", "slide along themselves"]),
    ({"time": {"end": 1.0, "scheme": "distance"}}, ["time.scheme", "pores", "reduced"]),
    ({"time": {"end": 1.0, "scheme": "backward-euler"}}, ["time.scheme", "pores"]),
]  # fmt: skip


@pytest.mark.parametrize(("sections", "words"), BAD, ids=lambda value: str(value)[:40])
def test_what_pores_cannot_be_made_for_is_refused_by_name(sections: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        parse_case(changed(**sections))
    message = str(caught.value)
    assert [word for word in words if word not in message] == []
    assert "\n" not in message


def test_a_mesh_file_is_refused(tmp_path: Any) -> None:
    (tmp_path / "a.msh").touch()
    with pytest.raises(InputError, match=r"domain\.mesh = .*pores are no mesh; drop it"):
        parse_case(changed(domain=BOX | {"mesh": str(tmp_path / "a.msh")}))


def test_the_tolerance_of_a_case_is_that_of_its_level() -> None:
    sections = {"pores": {"tolerance": 0.01}, "discretisation": {"tolerance": 0.1}}
    assert parse_case(changed(**sections)).tolerance == 0.01
    assert parse_case(changed(**sections, model="resolved")).tolerance == 0.1


def test_a_gap_narrower_than_digits_reach_is_refused() -> None:
    """Below 1e-8 radii a gap is a difference of places that rounding leaves no digits of."""
    near = {"name": "one", "radius": 1.0, "position": [2.0, 1.000000001]}
    case = parse_case(changed(bodies=[near]))
    with pytest.raises(InputError, match=r"the gap between 'one' and 'bottom' is 1e-09"):
        check_work(case)


@pytest.mark.parametrize(
    ("pores", "message"),
    [
        ({"modes": 16, "tolerance": 0.5}, r"^pores\.modes = 16: a tolerance takes 12 at most, .* drop one"),
        ({"modes": True}, r"^pores\.modes = true: is no number; give one"),
    ],
)
def test_modes_that_cannot_be_are_refused(pores: dict[str, Any], message: str) -> None:
    """16 with a tolerance were said not to reach 2/3 of it; true was taken for 1."""
    with pytest.raises(InputError, match=message):
        parse_case(changed(pores=pores))
    parse_case(changed(pores={"modes": 12, "tolerance": 0.5}))
