"""Walls of one's own domains: their names, and what curved ones follow, in all units of length."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, override

import numpy as np
import pytest
from pydantic import Field

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.domains.domain import Walled, register_domain
from fsi.case.load import parse_case
from fsi.case.section import Geometry
from fsi.errors import InputError
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.curves import WallCurve
from fsi.meshes.geometry.outline import Outline
from fsi.meshes.geometry.placed import Placed
from fsi.stokes.model import StokesModel


class LateDomain(Walled):
    """Its key decides the walls, and stands after them: pydantic takes the keys of base classes first."""

    shape: Literal["late-of-tests"]
    radius: float = Field(gt=0.0, description="half a side, a number > 0")
    sides: int = Field(default=2, description="how many walls wall_names knows of, a whole number")

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        return ("left", "right", "bottom", "top")[: known.get("sides", 2)]

    @override
    def container(self) -> Container:
        return Box((-self.radius, -self.radius), (self.radius, self.radius))


@dataclass(frozen=True, slots=True)
class Ring(Container):
    """The circle of a radius around the origin, whose wall follows the outline of a disc, or nothing."""

    radius: float
    told: str = "solid"
    walls: ClassVar[tuple[str, ...]] = ("rim",)

    def distances(self, x: Array) -> Array:
        away: Array = self.radius - np.hypot(*x.T)[:, None]
        return away

    def normals(self, x: Array) -> Array:
        inwards: Array = -x / np.maximum(np.hypot(*x.T), 1e-300)[:, None]
        return inwards[:, None]

    def outline(self) -> tuple[WallCurve, ...]:
        R = self.radius
        half = np.pi * R
        solid = Placed(Outline.disc(1.1 * R if self.told == "larger" else R), np.zeros(2), 0.0)
        centre = np.array([0.1 * R, 0.0]) if self.told == "centre" else None

        def at(s: Array) -> Array:
            return R * np.column_stack([np.cos(s / R), np.sin(s / R)])

        ends = np.array([[R, 0.0], [-R, 0.0]])
        pieces = (((0.0, half), ends), ((half, 2.0 * half), ends[::-1]))
        follows = solid if self.told in ("solid", "larger") else None
        return tuple(
            WallCurve(0, interval, at, ends, 0.5 * R, 8, centre, follows) for interval, ends in pieces
        )

    @property
    def plane(self) -> tuple[bool, ...]:
        return (False,)

    @property
    def waves(self) -> tuple[float, ...]:
        return (2.0 * self.radius,)

    def bends(self, x: Array) -> Array:
        return np.full((len(x), 1), self.radius)

    def size(self) -> float:
        return 2.0 * self.radius

    @property
    def volume(self) -> float:
        return float(np.pi * self.radius**2)


class RingDomain(Walled):
    shape: Literal["ring-of-tests"]
    radius: float = Field(gt=0.0, description="the radius, a number > 0")
    told: str = Field(default="solid", description="what its wall follows, a word")

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        return Ring(1.0).walls

    @override
    def container(self) -> Container:
        return Ring(self.radius, self.told)


@pytest.fixture(autouse=True)
def registered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Registered for one test only: messages list all shapes."""
    monkeypatch.setattr(Walled.registry, "sections", [*Walled.registry.all()])
    for domain in (LateDomain, RingDomain):
        register_domain(domain)


def moving(a: float, **domain: Any) -> Case:
    """A disc of radius a in the middle of a domain of radius 3 a, unless another one is given."""
    disc = {"name": "disc", "radius": a, "position": [0.0, 0.0], "velocity": [1.0, 0.0]}
    data = {"name": "own walls", "fluid": {"viscosity": 1.0}, "domain": {"radius": 3.0 * a} | domain}
    return parse_case(data | {"bodies": [disc]})


def test_a_key_that_decides_the_walls_is_known_before_them() -> None:
    """It ended in an error of `zip`."""
    with pytest.raises(
        InputError,
        match=r'shape = "late-of-tests": .*walls left, right, bottom, top, its wall_names left, right; ',
    ):
        moving(1.0, shape="late-of-tests", sides=4)


@pytest.mark.parametrize(
    ("told", "fault"),
    [("nothing", "is curved"), ("centre", "is no arc around its centre"), ("larger", "is off the outline")],
)
def test_a_curved_wall_says_what_it_follows(told: str, fault: str) -> None:
    """It was meshed as a polygon, with a force 0.9 % off and nothing said."""
    with pytest.raises(
        InputError, match=rf'domain\.shape = "ring-of-tests": a piece of its wall \'rim\' {fault}.*centre'
    ):
        moving(1.0, shape="ring-of-tests", told=told)


def test_a_curved_wall_has_the_same_flow_in_all_units() -> None:
    """The drag of a disc in the middle of a round container of three radii, per mu V, in any unit of length.

    4 pi / (ln k - (k^2 - 1) / (k^2 + 1)) with k = 3. The wall was a polygon in all units but one, which gave
    1e-2 more.
    """
    cases = [moving(a, shape="ring-of-tests") for a in (1.0, 0.5)]
    F = [StokesModel(case)(case.configuration(), 0.0).F[0, 0] for case in cases]
    np.testing.assert_allclose(F, 4.0 * np.pi / (np.log(3.0) - 0.8), rtol=1e-5)


def test_a_container_in_other_units_is_the_same_larger() -> None:
    """Of a ring, whose wall bends with its radius and is not plane."""
    ring, larger = Ring(3.0).scaled(2.0), Ring(6.0)
    x = np.array([[1.0, 2.0], [-3.0, 0.5]])
    np.testing.assert_allclose(ring.bends(x), larger.bends(x), rtol=1e-15)
    assert (ring.plane, ring.waves) == (larger.plane, larger.waves)
    for piece, other in zip(ring.outline(), larger.outline(), strict=True):
        assert piece.solid is not None
        np.testing.assert_allclose(piece.solid.signed_distance(other.at(other.samples))[0], 0.0, atol=1e-12)
