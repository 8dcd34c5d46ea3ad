"""The one line that each mistake in a case gives."""

import contextlib
import copy
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsi.case.checks.determined import require_determined_at_rest
from fsi.case.checks.expected import check_expected
from fsi.case.domains.domain import Walled
from fsi.case.load import parse_case
from fsi.errors import InputError
from tests.case_data import BOX, changed


def message(data: dict[str, Any]) -> str:
    with pytest.raises(InputError) as caught:
        parse_case(data)
    return str(caught.value)


def expected(quantity: str, **given: Any) -> dict[str, Any]:
    """A row of [[expected]]."""
    return {"quantity": quantity, "rtol": 1e-4, "source": "x", **(given or {"value": 1.0})}


# key, bad value, what the line must say besides the key: the value, the mistake, the remedy
BAD = [
    ("fluid.viscosity", -1.0, ["-1.0", "greater than 0", "give the dynamic viscosity"]),
    ("fluid.viscosity", 0.0, ["0.0", "greater than 0"]),
    ("fluid.viscosity", math.nan, ["nan", "finite"]),
    ("fluid.viscosity", "1.0", ['"1.0"', "valid number"]),
    ("fluid.viscosity", True, ["true", "valid number"]),
    ("fluid.viscosity", None, ["missing", "give the dynamic viscosity"]),
    ("domain", None, ["missing", f"of shape {Walled.registry.choices}"]),
    ("fluid.viscocity", 1.0, ["unknown key", "use fluid.viscosity"]),
    ("fluids", {}, ["unknown key", "use fluid "]),
    ("fluid", {1: 2}, ["fluid.1 = 2", "unknown key", "use fluid.viscosity"]),
    ("body_defaults", {1: 2}, ["body_defaults.1", "unknown key"]),
    ("domain.angles", 1.0, ["unknown key", "use domain.shape, domain.walls"]),  # none is like it
    ("discretization", {}, ["unknown key", "use discretisation"]),
    ("grids", [{"contents": 3}], ["grids.0.contents = 3", "unknown key; use grids.0.counts or drop it"]),
    ("grids", [5], ["grids.0 = 5: not a section"]),
    ("discretisation.cells_per_cicle", 3, ["use discretisation.cells_per_circle"]),
    ("discretisation.degree", 7, ["7", "2 to 6"]),
    ("discretisation.degree", 2.5, ["2.5", "integer"]),
    ("discretisation.formulation", "saddle", ['"eliminated" or "multiplier"']),
    ("geometry", "spherical", ["planar"]),
    ("domain.lower", [9.0, 0.0], ["domain.upper"]),
    ("domain.upper", [8.0], ["a corner has 1 component where this geometry has 2"]),
    ("domain.upper", [8.0, math.inf], ["finite"]),
    ("domain.radius", 1.0, ["unknown key"]),
    ("domain.shape", "disc", ['"disc"', f"give {Walled.registry.choices}"]),
    # A key of several shapes of domains: the remedy is that of the shape which is meant.
    (
        "domain",
        {"shape": "round", "radius": -1.0},
        ["domain.radius", "give a number > 0; the container"],
    ),
    (
        "domain",
        {"shape": "half-plane", "radius": -1.0},
        ["domain.radius", "the radius of the half disc"],
    ),
    ("domain.walls.botom", [0.0, 0.0], ["unknown key", "use domain.walls.bottom"]),
    ("domain.walls.top", "shut", ['"open"']),
    ("domain.walls.top", {"presure": 1.0}, ["use domain.walls.top.pressure"]),
    ("domain.walls.top", {"sheer": 1.0}, ["use domain.walls.top.shear"]),
    ("domain.walls.top", [0.0, 1.0], ["net flux", "16", "open"]),
    ("domain.mesh", "/nowhere.msh", ["no such file"]),
    ("bodies.0.radius", -1.0, ["-1.0", "greater than 0"]),
    ("bodies.0.radius", 1.2, ["bodies.0.position", "'disc'", "'bottom'", "gap -0.1", "move"]),
    ("bodies.0.raduis", 1.0, ["use bodies.0.radius"]),
    ("bodies.0.slip_length", -0.1, ["-0.1", "greater than or equal to 0"]),
    ("bodies.0.slip_length", 1e-12, ["1e-12", "not resolved below 1e-09 of 1", "give 0"]),
    ("bodies.0.slip_length", math.inf, ["finite"]),
    ("bodies.0.surface_velocity", 1.0, ["must be a list"]),
    ("domain.walls.top", {"slip_length": 0.0}, ["domain.walls.top.slip_length", "greater than 0"]),
    ("domain.walls.top", {"slip_lenght": 0.1}, ["use domain.walls.top.slip_length"]),
    (
        "domain.walls.top",
        {"slip_length": 0.1, "velocity": [1.0]},
        ["domain.walls", "of top has 1 component where"],
    ),
    ("domain.walls.top", {"slip_length": 0.1, "velocity": [0.0, 1.0]}, ["net flux", "16"]),
    ("bodies.0.position", [0.0, 1.0], ["[0.0, 1.0]", "'bottom'", "gap 0"]),
    ("bodies.0.position", [9.5, 1.1], ["'right'", "gap -2.5"]),
    ("bodies.1.position", [1.5, 1.1], ["'disc' and 'other'", "gap -0.5", "move them apart"]),
    ("bodies.1.position", [2.0, 1.1], ["'disc' and 'other'", "gap 0"]),
    ("bodies.1.name", "disc", ["same name"]),
    ("bodies.1.name", "top", ["a wall has this name"]),
    ("bodies.1.name", "a,b", ["letters, digits"]),
    ("bodies.1.name", "-c 1", ["neither blank nor - first"]),
    ("bodies.0.velocity", ["free", "fixed"], ["bodies.0.velocity.1", '"fixed"', '"free"']),
    ("bodies.0.velocity", {"times": [0.0], "values": [1.0]}, ["must be a list"]),
    ("bodies.0.torque", {"times": [0.0, 1.0, 0.5], "values": [0.0, 1.0, 2.0]}, ["torque.times", "decrease"]),
    ("bodies.0.torque", {"times": 3 * [1.0], "values": [0.0, 1.0, 2.0]}, ["torque.times", "given twice"]),
    ("bodies.0.torque", {"times": [0.0, 1.0, 1.0], "values": [0.0, 1.0, 2.0]}, ["torque", "jumps at t = 1"]),
    ("bodies.0.initial_velocity", [1.0, 0.0], ["bodies.0.initial_velocity", "without a mass"]),
    ("time.scheme", "ascher", ["time.scheme", "ascher-ruuth-spiteri"]),
    ("time.scheme", "distance", ["time.scheme", "reduced"]),
    ("bodies.0.torque", {"times": [0.0, 1.0], "values": [0.0]}, ["2 times but 1 values"]),
    ("bodies.0.torque", {"time": [0.0], "values": [0.0]}, ["use bodies.0.torque.times"]),
    ("bodies.0.name", "fluid", ["fsi probe", "give another one"]),
    ("bodies.0.name", "outside", ["space outside the domain"]),
    ("bodies.0.mass", 1.0, ["without moment_of_inertia", "mass radius^2 / 2"]),
    ("bodies.0.moment_of_inertia", 1.0, ["without mass"]),
    ("time.end", 0.0, ["greater than 0"]),
    ("time.gap_loss", 1.0, ["less than 1"]),
    ("time.smallest_step", 6.0, ["not below time.end"]),
    ("time.first_step", 1e-12, ["time.first_step = 1e-12", "below time.smallest_step", "make it longer"]),
    ("time.remesh", "never", ['"always" or "when-needed"']),
    ("expected", [{"quantity": "disc.forse.x", "value": 1.0, "rtol": 1e-4, "source": "x"}], ["BODY.force.x"]),
]


@pytest.mark.parametrize(("key", "value", "words"), BAD)
def test_each_mistake_gives_one_line_with_key_value_and_remedy(
    key: str, value: Any, words: list[str]
) -> None:
    line = message(changed(key, value))
    assert "\n" not in line
    assert line.startswith(key if not words[0].startswith(("bodies", "domain")) else words[0])
    assert all(word in line for word in words), line


def test_the_number_of_further_mistakes_is_told() -> None:
    data = changed("fluid.viscosity", -1.0)
    data["time"]["end"] = -1.0
    assert message(data).endswith("(and 1 more)")


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (expected("disk.force.x"), "no such body; the nearest is 'disc'"),
        (expected("disc.force.z"), "no such component; give disc.force.x, disc.force.y"),
        (expected("disc.torque.x"), "no such component; give disc.torque"),
        (expected("apparent viscosity"), "periodic domain; give another, or drop expected.0 as a whole$"),
        (expected("disc.force.y", exact="two_discs"), 'shape = "round" and 2 of .*bodies'),
    ],
)
def test_rows_that_a_case_cannot_give_are_refused(row: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        check_expected(parse_case(changed("expected", [row])))


@pytest.mark.parametrize(
    ("key", "value", "change", "words"),
    [
        ("bodies.0.slip_length", 0.1, {"model": "reduced"}, 'model = "reduced" does not know it'),
        ("bodies.0.slip_length", 0.1, {"model": "pores"}, 'model = "pores" does not know it'),
        ("bodies.0.slip_length", 0.1, {"model": "gluey"}, 'model = "gluey" does not know it'),
        ("bodies.0.surface_velocity", [1.0], {"model": "reduced"}, "does not know it; drop it or give"),
        ("domain.walls.top", {"slip_length": 0.1}, {"model": "reduced"}, "slip_length = 0.1: model"),
        ("bodies.0.slip_length", 0.1, {"discretisation": {"formulation": "multiplier"}}, "drop that"),
    ],
)
def test_slip_is_known_to_the_resolved_model_alone(
    key: str, value: Any, change: dict[str, Any], words: str
) -> None:
    line = message(changed(key, value) | change)
    assert line.startswith(key)
    assert words in line


def test_only_what_is_round_swims() -> None:
    ellipse = {"name": "disc", "position": [0.0, 4.0], "shape": {"kind": "ellipse", "axes": [2.0, 1.0]}}
    data = changed("bodies", [ellipse | {"slip_length": 0.1}])
    parse_case(data)
    data["bodies"][0]["surface_velocity"] = [1.0]
    assert message(data).startswith("bodies.0.surface_velocity = [1.0]: its modes are those of discs")


def test_a_swimmer_on_an_axis_goes_along_it() -> None:
    ball = {"name": "ball", "radius": 1.0, "position": [0.0, 0.0], "surface_velocity": [1.0], "angle": 0.3}
    data = BOX | {"geometry": "axisymmetric", "domain": {"shape": "round", "radius": 3.0}, "bodies": [ball]}
    assert message(data) == "bodies.0.angle = 0.3: a swimmer goes along the axis; give 0.0 or 3.14159265"
    parse_case(data | {"bodies": [ball | {"angle": 3.14159265}]})


def test_what_slides_is_not_at_infinity() -> None:
    far = {"shape": "half-plane", "radius": 500.0, "walls": {"far": {"slip_length": 0.1}}}
    assert "this wall stands for infinity" in message(changed("domain", far))


def test_one_instant_is_not_determined_by_masses() -> None:
    """Its solve left a residual of 1.9; a run of the same case goes, as a held disc does."""
    data = changed("domain.walls", dict.fromkeys(("left", "right", "bottom", "top"), "open"))
    data["bodies"][0] |= {"mass": 1.0, "moment_of_inertia": 1.0}
    with pytest.raises(InputError, match=r"one instant is solved without inertia.* use `fsi run`"):
        require_determined_at_rest(parse_case(data))
    data["bodies"][1] |= {"velocity": [0.0, 0.0], "angular_velocity": 0.0}
    require_determined_at_rest(parse_case(data))


def test_a_load_on_a_held_component_is_refused() -> None:
    data = changed("bodies.0.velocity", ["free", -1.0])
    data["bodies"][0]["force"] = [1.0, 0.0]  # on the free component: fine
    parse_case(data)
    data["bodies"][0]["force"] = [0.0, {"times": [0.0, 1.0], "values": [0.0, 2.0]}]
    assert message(data).startswith(
        "bodies.0.force.1 = {times = [0.0, 1.0], values = [0.0, 2.0]}: body 'disc' holds"
    )


def opened(*bodies: dict[str, Any]) -> dict[str, Any]:
    """The bodies in a box all of whose walls are open."""
    data = copy.deepcopy(BOX)
    data["domain"]["walls"] = dict.fromkeys(("left", "right", "bottom", "top"), "open")
    data["bodies"] = [
        {"name": f"b{i}", "radius": 1.0, "position": [3.0 * i, 8.0]} | body for i, body in enumerate(bodies)
    ]
    return data


@pytest.mark.parametrize(
    "bodies",
    [
        [{}],
        [{"velocity": [0.0, 0.0]}],  # can turn about its centre together with the fluid
        [{"velocity": [0.0, "free"], "angular_velocity": 0.0}],
        [{"velocity": [0.0, "free"]}, {"velocity": [0.0, "free"]}],  # both at the same height
    ],
)
def test_a_rigid_motion_that_nothing_stops_is_refused(bodies: list[dict[str, Any]]) -> None:
    assert "the motion is not determined; give a wall a velocity or hold a body" in message(opened(*bodies))


@pytest.mark.parametrize(
    "bodies",
    [
        [{"velocity": [0.0, 0.0], "angular_velocity": 0.0}],
        [{"velocity": [0.0, 0.0]}, {"velocity": ["free", 0.0]}],
        [{"mass": 1.0, "moment_of_inertia": 0.5}],
    ],
)
def test_a_rigid_motion_that_bodies_stop_needs_no_wall(bodies: list[dict[str, Any]]) -> None:
    parse_case(opened(*bodies))


def test_the_flux_is_balanced_at_every_time() -> None:
    rise = {"times": [0.0, 1.0], "values": [0.0, 1.0]}
    data = changed("domain.walls.top", [0.0, rise])
    assert "net flux out of the closed domain is 16 at t = 1" in message(data)
    data["domain"]["walls"]["bottom"] = [0.0, rise]
    parse_case(data)


def test_a_shear_flow_through_the_sides_is_balanced() -> None:
    data = changed("domain.walls.left", {"shear": 1.0})
    assert "net flux out of the closed domain is -128" in message(data)  # int_0^16 y dy
    data["domain"]["walls"]["right"] = {"shear": 1.0}
    case = parse_case(data)
    assert case.wall_velocity(0.0)["right"].shear == 1.0


_words = st.sampled_from(
    ["free", "open", "box", "half-plane", "radius", "times", "pressure", "shear", "", "x"]
)
_values = st.recursive(
    st.booleans() | st.integers() | st.floats() | _words | st.just(10**400),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(_words, inner, max_size=2),
    max_leaves=6,
)
_keys = [
    *("name", "geometry", "fluid", "domain", "bodies", "discretisation", "time", "output", "expected"),
    *("fluid.viscosity", "domain.shape", "domain.lower", "domain.upper", "domain.walls", "domain.walls.top"),
    *(
        "domain.mesh",
        "bodies.0",
        "bodies.0.name",
        "bodies.0.radius",
        "bodies.0.position",
        "bodies.0.velocity",
    ),
    *("bodies.0.force", "bodies.0.torque", "bodies.0.mass", "time.end", "time.first_step", "output.interval"),
]


@given(key=st.sampled_from(_keys), value=_values)
def test_whatever_stands_at_a_key_the_answer_is_a_case_or_an_input_error(key: str, value: Any) -> None:
    with contextlib.suppress(InputError):
        parse_case(changed(key, value))
