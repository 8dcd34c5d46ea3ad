"""Case files: what they mean, how they are read and overridden."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.case.series import Table, polynomial, value_at
from fsi.errors import InputError
from tests.case_data import BOX, changed

CASES = sorted((Path(__file__).parents[2] / "cases").glob("*.toml"))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_the_resolved_case_reads_back_equal(path: Path, tmp_path: Path) -> None:
    case = load_case(path)
    resolved = tmp_path / "case.toml"
    resolved.write_text(case.as_toml())
    assert load_case(resolved) == case
    assert {"degree", "cells_per_gap", "growth"} <= set(tomllib.loads(case.as_toml())["discretisation"])
    assert case.expected or "No number is known" in path.read_text()


_numbers = st.floats(1e-50, 1e6) | st.just(0.0) | st.floats(-1e6, -1e-50)
_series = _numbers | st.lists(_numbers, min_size=1, max_size=3, unique=True).map(
    lambda times: {"times": sorted(times), "values": times}
)


@given(
    viscosity=st.floats(1e-50, 1e50),
    load=_series,
    velocity=_series | st.just("free"),
    end=st.floats(1e-3, 1e3),
    growth=st.floats(1e-3, 1.0),
)
def test_any_sound_case_reads_back_equal(
    viscosity: float, load: Any, velocity: Any, end: float, growth: float
) -> None:
    data = changed("fluid.viscosity", viscosity)
    data["bodies"][0] |= {"force": [load, 0.0], "angular_velocity": velocity}
    data |= {"time": {"end": end}, "discretisation": {"growth": growth}}
    case = parse_case(data)
    assert parse_case(tomllib.loads(case.as_toml())) == case


def test_defaults() -> None:
    case = parse_case(BOX)
    assert case.names == ("disc", "other")
    assert (case.discretisation.degree, case.discretisation.cells_per_gap) == (4, 0.45)
    assert case.time is not None
    assert case.time.smallest_step == pytest.approx(5e-9)
    assert case.masses() is None
    assert case.kinks() == ()
    assert not case.motion(0.0).held.any()
    assert list(case.wall_velocity(0.0)) == ["left", "right", "bottom", "top"]
    assert case.wall_pressure() == {}


@pytest.mark.parametrize(
    ("geometry", "domain", "fraction"),
    [
        ("axisymmetric", {"shape": "half-plane", "radius": 100.0}, 2.0 * 0.5**3 / 100.0**3),
        ("axisymmetric", {"shape": "round", "radius": 10.0}, 0.05**3),
        ("axisymmetric", {"lower": [0.0, 0.0], "upper": [2.0, 5.0]}, 4.0 / 3.0 * 0.5**3 / (2.0**2 * 5.0)),
        ("planar", {"shape": "round", "radius": 10.0}, 0.05**2),
    ],
)
def test_the_part_that_is_bodies(geometry: str, domain: dict[str, Any], fraction: float) -> None:
    """On an axis balls of a half ball, a ball or a cylinder, in the plane discs; by their formulas."""
    body = {"name": "body", "radius": 0.5, "position": [0.0, 2.0]}
    case = parse_case(BOX | {"geometry": geometry, "domain": domain, "bodies": [body]})
    assert case.fraction == pytest.approx(fraction, rel=1e-13)


def test_motion_and_loads_follow_their_tables() -> None:
    data = changed("bodies.0.velocity", [{"times": [1.0, 3.0], "values": [0.0, 4.0]}, "free"])
    data["bodies"][0] |= {"force": [0.0, -2.0], "mass": 2.0, "moment_of_inertia": 1.0}
    data["domain"]["walls"] = {
        "left": {"pressure": 3.0},
        "right": "open",
        "top": [{"times": [0.0, 2.0], "values": [0.0, 1.0]}, 0.0],
    }
    case = parse_case(data)
    assert case.kinks() == (0.0, 1.0, 2.0, 3.0)
    motion = case.motion(2.5)
    np.testing.assert_array_equal(motion.held, [[True, False, False], [False, False, False]])
    np.testing.assert_allclose(motion.U, [[3.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_allclose(motion.F, [[0.0, -2.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(case.masses(), [[2.0, 2.0, 1.0], [0.0, 0.0, 0.0]])
    assert case.motion(9.0).U[0, 0] == 4.0  # constant beyond the table
    np.testing.assert_allclose(case.wall_velocity(1.0)["top"].velocity, [0.5, 0.0])
    assert case.wall_pressure() == {"left": 3.0, "right": 0.0}


def test_a_case_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="frozen"):
        parse_case(BOX).fluid.viscosity = 2.0


def test_an_empty_table_of_expected_numbers_is_no_row_and_a_table_is_one() -> None:
    assert parse_case(changed("expected", {})).expected == ()
    row = {"quantity": "dissipation", "value": 1.0, "rtol": 1e-3, "source": "a book"}
    assert parse_case(changed("expected", row)).expected[0].source == "a book"


@pytest.fixture
def write(tmp_path: Path) -> Callable[[dict[str, Any]], Path]:
    """Writes a case file."""

    def write_case(data: dict[str, Any]) -> Path:
        path = tmp_path / "case.toml"
        path.write_text(tomli_w.dumps(data))
        return path

    return write_case


def test_a_mesh_is_sought_beside_the_case_file(
    write: Callable[[dict[str, Any]], Path], tmp_path: Path
) -> None:
    (tmp_path / "own.msh").touch()
    assert load_case(write(changed("domain.mesh", "own.msh"))).domain.mesh == str(tmp_path / "own.msh")


@pytest.mark.parametrize("overrides", ["fluid.viscosity=2", [2.0]])
def test_overrides_are_a_list_of_texts(write: Callable[[dict[str, Any]], Path], overrides: Any) -> None:
    with pytest.raises(InputError, match=r'^overrides = .*: give a list of texts, \["time\.end=20"\]$'):
        load_case(write(changed("fluid.viscosity", 1.0)), overrides)


@pytest.mark.parametrize(
    ("overrides", "read", "expected"),
    [
        (["fluid.viscosity=2"], lambda case: case.fluid.viscosity, 2.0),
        (["bodies.1.radius=0.5"], lambda case: case.bodies[1].radius, 0.5),
        (["bodies.1.position.0 = 4.0"], lambda case: case.bodies[1].position, (4.0, 1.1)),
        (
            ["discretisation.formulation=multiplier"],
            lambda case: case.discretisation.formulation,
            "multiplier",
        ),
        (["domain.walls.top=[1.0, 0.0]"], lambda case: case.wall_velocity(0.0)["top"].velocity[0], 1.0),
        (["time.end=1", "time.end=2"], lambda case: case.time.end, 2.0),
        (
            ["discretisation.degree=2", "discretisation.degree = none"],
            lambda case: case.discretisation.degree,
            4,
        ),
        (["discretisation.tolerance=none"], lambda case: case.tolerance, None),
        (["bodies.1.mass=2", "bodies.1.mass=none"], lambda case: case.bodies[1].mass, None),
        (
            ["domain.walls.top.shear=none", "domain.walls.top=none"],
            lambda case: case.names,
            ("disc", "other"),
        ),
        (["time=none", "time.end=none"], lambda case: case.time, None),
        (['name="none"'], lambda case: case.name, "none"),
    ],
)
def test_overrides(
    write: Callable[[dict[str, Any]], Path], overrides: list[str], read: Callable[[Case], Any], expected: Any
) -> None:
    assert read(load_case(write(BOX), overrides)) == expected


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("fluid.viscocity=2", "fluid.viscocity = 2: unknown key; use fluid.viscosity"),
        ("flluid.viscosity=2", "unknown key; use fluid "),
        ("fluid.viscosity", "no key=value; write key=value"),
        ("fluid.viscosity=1 2", "the value is not TOML"),
        ("fluid.viscosity=", "the value is not TOML"),
        ("fluid.viscosity=thick", 'fluid.viscosity = "thick": must be a valid number'),
        ("fluid.viscosity.x=1", "fluid.viscosity = 1.0 is no section; set fluid.viscosity itself"),
        ("fluid.viscosity=none", "fluid.viscosity: missing; give the dynamic viscosity mu, a number > 0"),
        ("time.end=none", "time.end: missing; give the time at which the run ends"),
        (
            "discretisation.tolerence=none",
            "tolerence=none: unknown key; use discretisation.tolerance or drop it",
        ),
        ("bodies.0.raduis=none", "--set bodies.0.raduis=none: unknown key; use bodies.0.radius or drop it"),
        ("bodies.0.position.1=none", 'bodies.0.position.1 = "none": must be a valid number'),
        ("bodies.disc=none", "no bodies.disc; the list has the entries 0 to 1"),
        ("bodies.2.radius=none", "no bodies.2; the list has the entries 0 to 1"),
        ('discretisation.tolerance="none"', "in (0, 1), or leave it out"),
        ("bodies.2.radius=1", "no bodies.2; the list has the entries 0 to 1"),
        ("bodies.01.radius=1", "no bodies.01; the list has the entries 0 to 1"),
        ("bodies.disc.radius=1", "no bodies.disc; the list has the entries 0 to 1"),
    ],
)
def test_bad_overrides(write: Callable[[dict[str, Any]], Path], override: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        load_case(write(BOX), [override])
    assert words in str(caught.value)


def test_an_override_of_an_entry_of_an_empty_list(write: Callable[[dict[str, Any]], Path]) -> None:
    """It had "the entries 0 to -1"."""
    with pytest.raises(InputError, match=r"^--set bodies\.0\.radius=1: no bodies\.0; the list is empty$"):
        load_case(write(BOX), ["bodies=[]", "bodies.0.radius=1"])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "No such file"),
        (b"", "the case is empty"),
        (b"# nothing\n", "the case is empty"),
        (b"viscosity 1", "not TOML"),
        (b"\xff\xfe", "not TOML"),
    ],
)
def test_bad_files(tmp_path: Path, content: bytes | None, words: str) -> None:
    path = tmp_path / "case.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        load_case(path)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)


def test_a_folder_is_no_case_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="Is a directory"):
        load_case(tmp_path)


SIZES = ("degree", "cells_per_gap", "cells_per_circle", "growth", "interior")


@pytest.mark.parametrize(
    ("number", "sizes", "others"),
    [
        (20, (4, 0.45, 32, 0.33, "graded"), (3, 1.0, 48, 0.1, "graded")),
        (21, (4, 0.3, 20, 0.3, "sparse"), (3, 0.5, 24, 0.1, "graded")),
    ],
)
def test_elements_are_quartic_unless_a_size_is_named(
    number: int, sizes: tuple[object, ...], others: tuple[object, ...]
) -> None:
    bodies = [{"name": f"disc{i}", "radius": 0.01, "position": [0.1 * i - 1.5, 3.0]} for i in range(number)]
    found = parse_case(changed("bodies", bodies)).discretisation
    assert tuple(getattr(found, name) for name in SIZES) == sizes
    finer = parse_case(changed("bodies", bodies) | {"discretisation": {"growth": 0.1}}).discretisation
    assert tuple(getattr(finer, name) for name in SIZES) == others


def test_the_velocity_at_the_beginning_is_the_prescribed_one_where_there_is_one() -> None:
    heavy = {"mass": 1.0, "moment_of_inertia": 1.0, "initial_velocity": [0.0, 3.0]}
    moving = {"velocity": [{"times": [0.0, 1.0], "values": [2.0, 5.0]}, "free"]}
    data = changed("bodies.0", {"name": "disc", "radius": 1.0, "position": [0.0, 4.0]} | heavy | moving)
    np.testing.assert_allclose(parse_case(data).initial_velocity()[0], [2.0, 3.0, 0.0])


@pytest.mark.parametrize(("t", "integral"), [(0.5, 0.5), (1.0, 1.0), (2.0, 2.5), (4.0, 6.5)])
def test_a_table_is_constant_before_its_first_time_and_after_its_last(t: float, integral: float) -> None:
    """1 until t = 1, then to 2 at t = 2, and 2 for ever."""
    table = Table(times=(1.0, 2.0), values=(1.0, 2.0))
    assert float(polynomial(table, 4.0).antiderivative()(t)) == pytest.approx(integral, rel=1e-14)
    assert value_at(table, 4.0) == 2.0
