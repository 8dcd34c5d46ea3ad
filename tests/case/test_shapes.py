"""The key `shape` of bodies: what is read, refused by name, and registered from outside."""

from __future__ import annotations

import copy
import tomllib
from contextlib import nullcontext
from pathlib import Path
from typing import Any, Literal, override

import numpy as np
import pytest
import tomli_w

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.case.section import Positive
from fsi.case.shapes.shape import BodyShape, register_shape
from fsi.errors import InputError
from fsi.meshes.geometry.jets import JetOf, polar

ELLIPSE = {"kind": "ellipse", "axes": [2.0, 1.0]}
DATA: dict[str, Any] = {
    "name": "shaped",
    "fluid": {"viscosity": 1.0},
    "domain": {"lower": [-8.0, -8.0], "upper": [8.0, 8.0]},
    "bodies": [{"name": "body", "position": [0.0, 0.0], "shape": ELLIPSE}],
}


def shaped(shape: dict[str, Any] | None = None, **body: Any) -> Case:
    data = copy.deepcopy(DATA)
    data["bodies"][0] |= {"shape": shape or ELLIPSE} | body
    return parse_case(data)


def test_a_shape_says_how_large_a_body_is() -> None:
    """Its radius is that of the circle that holds it, its share of the domain its area."""
    case = shaped()
    assert case.bodies[0].radius == pytest.approx(2.0, rel=1e-14)
    assert case.fraction == pytest.approx(2.0 * np.pi / 256.0, rel=1e-13)


def test_a_uniform_body_knows_its_moment_of_inertia() -> None:
    """m (a^2 + b^2) / 4 of an ellipse."""
    masses = shaped(mass=3.0).masses()
    assert masses is not None
    np.testing.assert_allclose(masses, [[3.0, 3.0, 3.0 * 5.0 / 4.0]], rtol=1e-13)


def test_a_case_with_shapes_is_written_and_read_again() -> None:
    case = shaped(angle=0.4)
    assert parse_case(tomllib.loads(case.as_toml())) == case
    assert "radius" not in case.as_data()["bodies"][0]


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ({"kind": "elipse", "axes": [2.0, 1.0]}, r'shape\.kind = "elipse": .*"ellipse".*"tip"$'),
        ({"kind": "egg-of-tests", "a": 1.0}, r'"egg-of-tests": .*"tip"; one of your own must be registered'),
        ({"kind": "ellipse", "axes": [2.0, 0.0]}, r"shape\.axes.* = 0\.0: must be greater than 0"),
        ({"kind": "ellipse", "axis": 1.0}, r"shape\.axis = 1\.0: unknown key; use bodies\.0\.shape\.axes"),
        ({"kind": "ellipse", "axes": [1.0, 1e-6]}, "too slender or too jagged; give one that is rounder$"),
        ({"kind": "stadium", "length": 1e5, "radius": 0.1}, "too slender"),
        ({"kind": "fourier", "radius": 1.0, "orders": [200], "cosines": [0.3]}, "too jagged"),
        ({"kind": "ellipse", "axes": [1e-300, 1e-300]}, "too small or too large for numbers"),
        ({"kind": "ellipse", "axes": [1e300, 1e300]}, "too small or too large for numbers"),
        ({"kind": "spline", "points": "nowhere.csv"}, r'points = "nowhere\.csv": cannot be read'),
        (
            {"kind": "spline", "points": [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]]},
            "the same point twice",
        ),
        ({"kind": "fourier", "radius": 1.0, "orders": [2, 2], "cosines": [0.1, 0.1]}, "has the order 2 more"),
        (
            {"kind": "spline", "points": [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.5, -0.5], [0.0, 0.0]]},
            "runs clockwise",
        ),
        (
            {
                "kind": "spline",
                "points": [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [1.0, -1.0], [0.5, 2.0], [0.0, 1.0]],
            },
            "crosses itself",
        ),
    ],
)
def test_what_is_no_shape_is_refused_by_name(shape: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=rf"bodies\.0\.{message}" if "shape" in message else message):
        shaped(shape)


def test_a_shape_and_a_radius_contradict_each_other() -> None:
    with pytest.raises(InputError, match=r"bodies\.0\.radius = 1\.0: the shape says how large"):
        shaped(radius=1.0)
    with pytest.raises(InputError, match=r"bodies\.0\.radius: missing; give the radius"):
        parse_case(DATA | {"bodies": [{"name": "body", "position": [0.0, 0.0]}]})


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ({"model": "reduced", "reduced": {"drag": 10.0}}, 'model = "reduced" knows discs only'),
        ({"model": "pores"}, 'model = "pores" knows discs only'),
        (
            {
                "forces": [
                    {"kind": "repulsion", "law": "exponential", "strength": 1.0, "length": 1.0, "cutoff": 1.0}
                ]
            },
            "act between discs",
        ),
    ],
)
def test_what_knows_discs_only_refuses_shapes(sections: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=rf"bodies\.0\.shape = .*{message}"):
        parse_case(copy.deepcopy(DATA) | sections)


def on_axis(shape: dict[str, Any], **body: Any) -> Case:
    domain = {"lower": [0.0, -8.0], "upper": [8.0, 8.0]}
    bodies = [{"name": "body", "position": [0.0, 0.0], "shape": shape} | body]
    return parse_case(copy.deepcopy(DATA) | {"geometry": "axisymmetric", "domain": domain, "bodies": bodies})


def test_with_an_axis_a_shape_turns_around_it() -> None:
    """An ellipse is a spheroid, of volume 4/3 pi a^2 b; upright a stadium is a rod, pi a^2 l + 4/3 pi a^3."""
    case = on_axis({"kind": "ellipse", "axes": [1.0, 2.0]})
    assert case.configuration().volumes[0] == pytest.approx(8.0 / 3.0 * np.pi, rel=1e-13)
    assert case.bodies[0].half_axes == (1.0, 1.0, 2.0)
    rod = on_axis({"kind": "stadium", "length": 1.0, "radius": 0.5}, angle=0.5 * np.pi)
    assert rod.configuration().volumes[0] == pytest.approx(np.pi * (0.25 + 1.0 / 6.0), rel=1e-13)
    assert parse_case(tomllib.loads(rod.as_toml())) == rod


@pytest.mark.parametrize(
    ("shape", "angle", "message"),
    [
        (ELLIPSE, 0.1, r"is not symmetric about the axis r = 0 at the angle 0\.1"),
        (ELLIPSE, 3.14159265, r"all digits \(the nearest quarter turn at which it is: 3\.141592653589793\)$"),
        ({"kind": "fourier", "radius": 1.0, "orders": [3], "cosines": [0.1]}, 0.1, r"1\.5707963267948966\)"),
        (  # on one side of the axis, at all quarter turns
            {"kind": "polygon", "corners": [[2.0, 0.0], [3.0, 0.0], [3.0, 1.0]], "rounding": 0.1},
            0.0,
            r"is not symmetric .* or an angle to all digits$",
        ),
        (
            {"kind": "profile", "points": [[0.0, 0.0], [1.0, 1.0], [0.1, 2.0]]},
            0.0,
            r"\.shape\.points = .* x = 0 to x = 0 ",
        ),
        (
            {"kind": "profile", "points": [[0.0, 2.0], [1.0, 1.0], [0.0, 0.0]]},
            0.0,
            "not below the last; turn",
        ),
    ],
)
def test_what_is_no_body_of_revolution_is_refused(shape: dict[str, Any], angle: float, message: str) -> None:
    with pytest.raises(InputError, match=message):
        on_axis(shape, angle=angle)


ELLIPSOID = {"kind": "ellipsoid", "axes": [2.0, 1.0, 0.5]}


def in_space(*more: dict[str, Any], **body: Any) -> Case:
    domain = {"lower": [-8.0] * 3, "upper": [8.0] * 3}
    bodies = [{"name": "body", "position": [0.0] * 3, "shape": ELLIPSOID} | body, *more]
    return parse_case(copy.deepcopy(DATA) | {"geometry": "spatial", "domain": domain, "bodies": bodies})


def test_in_space_there_are_ellipsoids() -> None:
    """Of volume 4/3 pi a b c; a sphere beside one is one of equal axes."""
    case = in_space({"name": "sphere", "radius": 0.5, "position": [0.0, 3.0, 0.0]}, angle=[0.0, 0.0, 0.1])
    q = case.configuration()
    np.testing.assert_allclose(q.volumes, np.pi * np.array([4.0 / 3.0, 1.0 / 6.0]), rtol=1e-14)
    np.testing.assert_array_equal(q.radii, [2.0, 0.5])
    assert parse_case(tomllib.loads(case.as_toml())) == case


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (
            {"shape": ELLIPSE},
            r'bodies\.0\.shape .*is for geometry = "planar" and "axisymmetric"; give another',
        ),
        ({"shape": {"kind": "ellipsoid", "axes": [1.0, 1.0]}}, r"bodies\.0\.shape\.axes"),
        ({"mass": 1.0, "moment_of_inertia": 1.0}, r"bodies\.0\.mass = 1\.0: there are ellipsoids"),
        ({"surface_velocity": [1.0]}, r"bodies\.0\.surface_velocity .*those of discs and spheres"),
        ({"position": [0.0, 7.6, 0.0]}, "'body' touches or crosses wall 'back'"),
    ],
)
def test_what_ellipsoids_are_not_is_refused(body: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        in_space(**body)


@pytest.mark.parametrize(("part", "sound"), [(0.0199, False), (0.0201, True)])
def test_gaps_of_ellipsoids_below_those_that_are_meshed_are_refused(part: float, sound: bool) -> None:
    """0.02 of the smallest half axis, 0.5, to a wall and between bodies; 0.25 of a small one counts there."""
    wall = {"position": [0.0, 0.0, -7.5 + 0.5 * part]}
    small = {"name": "other", "position": [0.0, 1.5 + 0.25 * part, 0.0]}
    other = small | {"shape": {"kind": "ellipsoid", "axes": [1.0, 0.5, 0.25]}}
    to_wall = r"bodies\.0\.position = .*: the gap of 'body' to wall 'bottom' is 0\.00995, below .*, 0\.5; "
    to_body = r"bodies\.1\.position = .*: the gap of 'other' to 'body' is 0\.0049\d, below .*, 0\.25; "
    with nullcontext() if sound else pytest.raises(InputError, match=to_wall):
        in_space(**wall)
    with nullcontext() if sound else pytest.raises(InputError, match=to_body):
        in_space(other)


def test_ellipsoids_have_no_periods() -> None:
    domain = {"lower": [-8.0] * 3, "upper": [8.0] * 3, "periodic": ["x", "y"]}
    bodies = [{"name": "body", "position": [0.0] * 3, "shape": ELLIPSOID}]
    with pytest.raises(InputError, match=r"bodies\.0\.shape .*periodic domains in space take spheres only"):
        parse_case(DATA | {"geometry": "spatial", "domain": domain, "bodies": bodies})


def test_ellipsoids_are_refused_in_the_plane_and_where_they_overlap() -> None:
    with pytest.raises(InputError, match=r'bodies\.0\.shape .*is for geometry = "spatial"'):
        shaped(ELLIPSOID)
    near = {"name": "other", "position": [0.0, 0.0, 1.2], "shape": ELLIPSOID}
    in_space(near)
    with pytest.raises(InputError, match="'body' and 'other' overlap or touch"):
        in_space(near, angle=[1.2, 0.0, 0.0])


def test_bodies_of_shapes_that_overlap_are_refused() -> None:
    """Their circles overlap, which is allowed; then they do themselves."""
    data = copy.deepcopy(DATA)
    data["bodies"].append({"name": "other", "position": [0.0, 2.2], "shape": ELLIPSE})
    parse_case(data)
    data["bodies"][1]["angle"] = 1.5
    with pytest.raises(InputError, match="'body' and 'other' overlap or touch"):
        parse_case(data)
    data["bodies"][1]["position"] = [7.0, 0.0]
    data["bodies"][1]["angle"] = 0.0
    with pytest.raises(InputError, match="'other' touches or crosses wall 'right'"):
        parse_case(data)


def test_the_points_of_a_spline_may_stand_in_a_file_beside_the_case(tmp_path: Path) -> None:
    theta = 2.0 * np.pi * np.arange(40) / 40.0
    points = np.column_stack([2.0 * np.cos(theta), np.sin(theta)])
    np.savetxt(tmp_path / "points.csv", points, delimiter=",")
    data = copy.deepcopy(DATA)
    data["bodies"][0]["shape"] = {"kind": "spline", "points": "points.csv"}
    (tmp_path / "case.toml").write_text(tomli_w.dumps(data))
    case = load_case(tmp_path / "case.toml")
    outline = case.bodies[0].outline
    # The spline of 40 points is off its ellipse by some h^4 / 384 of the fourth derivative.
    assert outline.area == pytest.approx(2.0 * np.pi, rel=2e-5)
    assert parse_case(tomllib.loads(case.as_toml())) == case


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("text", "message"), [("", "no points"), ("# x, y\n\n", "no points"), ("x,y\n1,2\n", "'x'")]
)
def test_a_file_without_points_is_named(
    text: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """NumPy warned of an empty one, and what was refused was `points = []`."""
    (tmp_path / "points.csv").write_text(text)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=rf'"points\.csv": cannot be read \(.*{message}'):
        shaped({"kind": "spline", "points": "points.csv"})


def test_a_shape_from_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    """One class: here an egg r = a (1 + cos(theta) / 4), of area pi a^2 (1 + 1/32)."""
    monkeypatch.setattr(BodyShape.registry, "sections", [*BodyShape.registry.all()])

    @register_shape
    class Egg(BodyShape):
        """r = a (1 + cos(theta) / 4)."""

        kind: Literal["egg-of-tests"]
        size: Positive
        """the mean radius, a number > 0"""

        @override
        def curve(self) -> JetOf:
            a = self.size

            def radius(theta: Array) -> tuple[Array, Array, Array]:
                wave = 0.25 * a * np.cos(theta)
                return a + wave, -0.25 * a * np.sin(theta), -wave

            return polar(radius)

    case = shaped({"kind": "egg-of-tests", "size": 2.0})
    assert case.configuration().volumes[0] == pytest.approx(4.0 * np.pi * (1.0 + 1.0 / 32.0), rel=1e-13)
    with pytest.raises(InputError, match=r'bodies\.0\.shape\.kind = "eg-of-tests": .*or "egg-of-tests"'):
        shaped({"kind": "eg-of-tests", "size": 2.0})
