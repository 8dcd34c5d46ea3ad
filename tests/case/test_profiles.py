"""The key `profiles` of a domain: what is read, refused by name, and registered from outside."""

from __future__ import annotations

import copy
import tomllib
from typing import Any, Literal, NoReturn, override

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.bodies.gaps import wall_gaps
from fsi.case.case import Case
from fsi.case.checks import sound
from fsi.case.load import parse_case
from fsi.case.profiles.profile import WallProfile, register_profile
from fsi.errors import InputError
from fsi.meshes.geometry.relief import Heights

WAVE = {"kind": "wave", "height": 0.3, "length": 1.5, "number": 2, "start": -1.5}
TIP = {"kind": "tip", "place": 0.0, "height": 0.5, "alpha": 0.5, "length": 1.0, "rounding": 0.2}
DATA: dict[str, Any] = {
    "name": "over a wavy wall",
    "fluid": {"viscosity": 1.0},
    "domain": {"lower": [-8.0, 0.0], "upper": [8.0, 8.0]},
    "bodies": [{"name": "disc", "radius": 1.0, "position": [0.0, 2.0]}],
}


def profiled(profile: dict[str, Any] | None = None, wall: str = "bottom", **sections: Any) -> Case:
    data = copy.deepcopy(DATA) | {key: value for key, value in sections.items() if key != "domain"}
    data["domain"] |= {"profiles": {wall: profile or WAVE}} | sections.get("domain", {})
    return parse_case(data)


def test_a_case_with_a_wavy_wall_is_written_and_read_again() -> None:
    case = profiled()
    assert parse_case(tomllib.loads(case.as_toml())) == case
    # Bodies and fluid have what the crests leave: half the height times the length.
    assert case.container().volume == pytest.approx(16.0 * 8.0 - 0.5 * 0.3 * 3.0, rel=1e-13)


def test_gaps_are_those_to_the_true_wall() -> None:
    """A disc 2 over a tip of height 1/2."""
    case = profiled(TIP)
    gap = wall_gaps(case.configuration(), case.container())[0, 2]
    assert gap == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"profile": WAVE | {"kind": "waves"}}, r'profiles\.bottom\.kind = "waves": .*"tip" or "wave"'),
        ({"profile": WAVE | {"number": 0}}, r"profiles\.bottom\.number = 0: "),
        ({"profile": WAVE | {"start": -9.0}}, r"profiles\.bottom = .*stands from -9 to -6 on a wall from -8"),
        ({"profile": WAVE | {"height": 9.0}}, r"profiles\.bottom = .*reaches another wall"),
        ({"profile": TIP | {"height": 0.0}}, r"profiles\.bottom\.height = 0\.0: must be greater than 0"),
        ({"wall": "botom"}, r"domain\.profiles\.botom = .*unknown key; use domain\.profiles\.bottom"),
        ({"domain": {"walls": {"bottom": [1.0, 0.0]}}}, r"domain\.walls\.bottom = .*is at rest"),
        ({"domain": {"walls": {"bottom": "open"}}}, r"domain\.walls\.bottom = .*is at rest"),
        ({"domain": {"periodic": ["x"]}}, r"profiles\.bottom = .*periodic domains have straight walls"),
        ({"model": "reduced", "reduced": {"drag": 1.0}}, r'domain\.profiles: model = "reduced"'),
        ({"geometry": "axisymmetric"}, r'domain\.profiles = .*where geometry = "planar"'),
    ],
)
def test_what_is_no_shape_of_a_wall_is_refused_by_name(change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        profiled(**change)


def test_a_body_in_a_crest_is_refused() -> None:
    """The disc at y = 1.25 is above the plane wall, and on a crest of 0.3."""
    body = {"name": "disc", "radius": 1.0, "position": [-0.75, 1.25]}
    with pytest.raises(InputError, match=r"'disc' touches or crosses wall 'bottom' \(gap -0.05"):
        profiled(bodies=[body])


@pytest.mark.parametrize(
    ("size", "here"),
    [
        ({"radius": 20.0}, "radius = 20.0"),
        ({"radius": 1e9}, r"radius = 1000000000\.0"),
        ({"shape": {"kind": "ellipse", "axes": [1e9, 1e8]}}, r'shape = \{kind = "ellipse", .*\}'),
    ],
)
def test_a_body_larger_than_the_domain_is_refused_at_once(
    size: dict[str, Any], here: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Points beside each wave all around it filled the memory. Its size: 17.8885, the diagonal, + 1.5."""

    def followed(*_: object) -> NoReturn:
        raise AssertionError("the outline is followed")

    monkeypatch.setattr(sound, "wall_gaps", followed)
    message = (
        rf"^bodies\.0\.{here}: body 'disc' is larger than the domain \(of the size 19\.3885\); shrink it"
    )
    with pytest.raises(InputError, match=message):
        profiled(bodies=[{"name": "disc", "position": [0.0, 2.0]} | size])


def test_a_shape_of_walls_from_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    """One class: here a bump (1 - x^2)^2, of area 16/15."""
    monkeypatch.setattr(WallProfile.registry, "sections", [*WallProfile.registry.all()])

    @register_profile
    class Bump(WallProfile):
        """(1 - x^2)^2."""

        kind: Literal["bump-of-tests"]

        @override
        def heights(self) -> Heights:
            def at(x: Array) -> tuple[Array, Array, Array]:
                return (1.0 - x**2) ** 2, -4.0 * x * (1.0 - x**2), 12.0 * x**2 - 4.0

            return Heights((-1.0, 1.0), (), at)

    case = profiled({"kind": "bump-of-tests"}, bodies=[])
    assert case.container().volume == pytest.approx(128.0 - 16.0 / 15.0, rel=1e-13)
    assert case.container().distances(np.array([[0.0, 1.5]]))[0, 2] == pytest.approx(0.5, rel=1e-12)
