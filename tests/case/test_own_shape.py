"""One more shape of domain, and one more law of force, are one class and one section: here, from outside."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, override

import numpy as np
import pytest
from pydantic import Field

from fsi.arrays import Array
from fsi.bodies.forces import Bulk
from fsi.case.case import Case
from fsi.case.domains.domain import Walled, register_domain
from fsi.case.force_laws.law import ForceSection, register_force
from fsi.case.load import parse_case
from fsi.case.section import Geometry
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.curves import WallCurve, segment
from fsi.reduced.model import ReducedModel
from fsi.stokes.model import StokesModel


@dataclass(frozen=True, slots=True)
class Triangle(Container):
    """The equilateral triangle around the origin with an inscribed circle of that radius."""

    radius: float

    @property
    def walls(self) -> tuple[str, ...]:
        return ("bottom", "right", "left")

    @property
    def _normals(self) -> Array:
        angle = np.pi * np.array([1.0 / 2.0, 7.0 / 6.0, 11.0 / 6.0])
        return np.column_stack([np.cos(angle), np.sin(angle)])

    def distances(self, x: Array) -> Array:
        away: Array = self.radius + x @ self._normals.T
        return away

    def normals(self, x: Array) -> Array:
        return np.broadcast_to(self._normals, (len(x), 3, 2))

    def outline(self) -> tuple[WallCurve, ...]:
        angle = np.pi * np.array([7.0 / 6.0, 11.0 / 6.0, 1.0 / 2.0])
        corners = 2.0 * self.radius * np.column_stack([np.cos(angle), np.sin(angle)])
        return tuple(segment(k, corners[k], corners[(k + 1) % 3]) for k in range(3))

    def size(self) -> float:
        return float(2.0 * 3.0**0.5 * self.radius)

    @property
    def volume(self) -> float:
        return float(3.0 * 3.0**0.5 * self.radius**2)


class TriangleDomain(Walled):
    shape: Literal["triangle-of-tests"]
    radius: float = Field(gt=0.0, description="the radius of the inscribed circle, a number > 0")
    corners: Literal["sharp"] = Field(default="sharp", description='"sharp"')

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        return Triangle(1.0).walls

    @override
    def container(self) -> Container:
        return Triangle(self.radius)


class Spring(ForceSection):
    """Pulls each body by itself, as heavy as it may be, to the right."""

    law: Literal["spring-of-tests"]
    pull: float = Field(description="the force, a number")

    @override
    def on_bodies(self, bulk: Bulk, t: float) -> Array:
        return np.column_stack([np.full(len(bulk.masses), self.pull), np.zeros(len(bulk.masses))])


@pytest.fixture(autouse=True)
def registered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Registered for one test only: messages list all shapes."""
    for registry in (Walled.registry, ForceSection.registry):
        monkeypatch.setattr(registry, "sections", [*registry.all()])
    register_domain(TriangleDomain)
    register_force(Spring)


def in_triangle(velocity: list[Any], **domain: Any) -> Case:
    disc = {"name": "disc", "radius": 1.0, "position": [0.0, 0.0], "velocity": velocity}
    data = {
        "name": "in a triangle",
        "fluid": {"viscosity": 1.0},
        "domain": {"shape": "triangle-of-tests", "radius": 1.3} | domain,
        "bodies": [disc],
        "discretisation": {"cells_per_circle": 24, "growth": 0.5},
        "reduced": {"drag": 10.0},
    }
    return parse_case(data)


@pytest.mark.parametrize("model", [StokesModel, ReducedModel])
def test_a_disc_is_resisted_alike_in_all_directions(model: Any) -> None:
    """By the symmetry of the triangle R is a multiple of the identity, though its walls are not alike."""
    F = []
    for direction in ([1.0, 0.0], [0.0, 1.0]):
        case = in_triangle(direction)
        F.append(model(case)(case.configuration(), 0.0).F[0, :2])
    assert F[0][0] > 30.0
    np.testing.assert_allclose(F, F[0][0] * np.eye(2), atol=1e-4 * F[0][0])


def test_its_walls_are_checked_like_those_of_all_shapes() -> None:
    """What flows in through one side of three flows out through the two others, at half the speed normal."""
    normal = np.array([[0.0, 1.0], [-np.sqrt(0.75), -0.5], [np.sqrt(0.75), -0.5]])
    walls = dict(zip(Triangle(1.0).walls, (normal * [[1.0], [-0.5], [-0.5]]).tolist(), strict=True))
    in_triangle([0.0, 0.0], walls=walls)
    with pytest.raises(InputError, match=r"domain\.walls\.bottom = .*net flux"):
        in_triangle([0.0, 0.0], walls=walls | {"left": [0.0, 0.0]})
    with pytest.raises(InputError, match=r"domain\.walls\.top = .*unknown key; use domain\.walls\.bottom"):
        in_triangle([0.0, 0.0], walls={"top": [0.0, 0.0]})


def test_it_is_known_by_name_and_by_its_keys() -> None:
    with pytest.raises(
        InputError, match=r'domain\.shape = "tringle-of-tests": .*; give "box", .* or "triangle-of-tests"'
    ):
        in_triangle([0.0, 0.0], shape="tringle-of-tests", corners="sharp")
    with pytest.raises(InputError, match=r'domain\.corners = "round": not one of the choices; give "sharp"'):
        in_triangle([0.0, 0.0], corners="round")


def test_a_case_with_it_is_written_and_read_again() -> None:
    case = in_triangle([0.0, 1.0])
    assert parse_case(tomllib.loads(case.as_toml())) == case


def test_a_law_of_force_from_outside() -> None:
    case = in_triangle(["free", "free"])
    data = case.model_dump(exclude_none=True) | {"forces": ({"law": "spring-of-tests", "pull": 3.0},)}
    case = parse_case(data)
    np.testing.assert_array_equal(case.motion_at(case.configuration(), 0.0).F, [[3.0, 0.0, 0.0]])
    with pytest.raises(
        InputError, match=r'forces\.0\.law = "sprung-of-tests": .*"power", .* or "spring-of-tests"'
    ):
        parse_case(data | {"forces": ({"law": "sprung-of-tests", "pull": 3.0},)})
