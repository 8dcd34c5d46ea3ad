"""The domain of a case: the container of the fluid and what holds at its walls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag, field_validator

from fsi.bodies import Array
from fsi.section import Section, nearest_word, refuse_unknown
from fsi.series import Series, kinks, value_at
from meshes.geometry import Box, Container, HalfPlane, Round


@dataclass(frozen=True, slots=True)
class WallVelocity:
    """The velocity of the fluid at a wall, `u(x, y) = velocity + shear y e_x`; velocity has shape (2,)."""

    velocity: Array
    shear: float


class Pressure(Section):
    """An open wall: the traction there is `sigma n = -pressure n`."""

    pressure: float = Field(description="the pressure outside an open wall, a number")


class Shear(Section):
    """A wall on which the fluid has the shear flow `u = shear y e_x`."""

    shear: float = Field(description="the shear rate of the flow shear y e_x at the wall, a number")


def _wall_kind(value: Any) -> str:
    match value:
        case str():
            return "<word>"
        case dict() if value:
            return f"<{nearest_word(str(next(iter(value))), ('pressure', 'shear'))}>"
        case Pressure() | dict():
            return "<pressure>"
        case Shear():
            return "<shear>"
        case _:
            return "<velocity>"


Wall = Annotated[
    Annotated[Literal["open"], Tag("<word>")]
    | Annotated[tuple[Series, Series], Tag("<velocity>")]
    | Annotated[Pressure, Tag("<pressure>")]
    | Annotated[Shear, Tag("<shear>")],
    Discriminator(_wall_kind),
]

AT_REST: tuple[float, float] = (0.0, 0.0)


_SHAPES = '"box", "half-plane" or "round"'


class _Walled(Section):
    """What all domains have: a condition at every wall, and perhaps the user's own mesh of the shape."""

    # Put here by the case, which knows its geometry; the brackets keep it out of the user's reach.
    axisymmetric: bool = Field(default=False, alias="<axisymmetric>", exclude=True)
    walls: dict[str, Wall] = Field(
        default={},
        validate_default=True,
        description='for each wall its velocity [u_x, u_y], "open", {pressure = p} or {shear = rate}',
    )
    mesh: str | None = Field(
        default=None, description="the path of a mesh file of this shape, seen from the case file's folder"
    )

    @field_validator("walls")
    @classmethod
    def _complete(cls, walls: dict[str, Wall], info: Any) -> dict[str, Wall]:
        return _all_walls(walls, cls.wall_names(info.data["axisymmetric"]))

    @classmethod
    def wall_names(cls, axisymmetric: bool) -> tuple[str, ...]:
        """Names of the walls of this shape."""
        raise NotImplementedError

    def container(self) -> Container:
        """The geometry."""
        raise NotImplementedError


def _all_walls(given: dict[str, Wall], names: tuple[str, ...]) -> dict[str, Wall]:
    """The conditions of all walls in the container's order, at rest where none is given."""
    for name in given:
        refuse_unknown(name, names)
    return {name: given.get(name, AT_REST) for name in names}


class BoxDomain(_Walled):
    """The rectangle [lower, upper] with the walls left, right, bottom, top."""

    shape: Literal["box"] = Field(default="box", description=_SHAPES)
    lower: tuple[float, float] = Field(description="the lower left corner [x, y], left of and below `upper`")
    upper: tuple[float, float] = Field(
        description="the upper right corner [x, y], right of and above `lower`"
    )

    @classmethod
    def wall_names(cls, axisymmetric: bool) -> tuple[str, ...]:
        """left, right, bottom, top; a cylinder has no left."""
        return Box(AT_REST, AT_REST, axisymmetric).walls

    @field_validator("upper")
    @classmethod
    def _right_way_round(cls, upper: tuple[float, float], info: Any) -> tuple[float, float]:
        lower = info.data.get("lower", (-np.inf, -np.inf))
        if not (lower[0] < upper[0] and lower[1] < upper[1]):
            raise ValueError(f"does not lie to the right of and above lower = {list(lower)}")
        return upper

    def container(self) -> Container:
        """The geometry."""
        return Box(self.lower, self.upper, self.axisymmetric)


class HalfPlaneDomain(_Walled):
    """The half disc y > 0 (half ball z > 0) of large radius that stands for the half-plane (half-space)."""

    shape: Literal["half-plane"] = Field(description=_SHAPES)
    radius: float = Field(
        gt=0.0, description="the radius of the half disc, a number > 0, some 100 body radii"
    )

    @classmethod
    def wall_names(cls, axisymmetric: bool) -> tuple[str, ...]:
        """plane and far."""
        return HalfPlane(1.0, axisymmetric).walls

    def container(self) -> Container:
        """The geometry."""
        return HalfPlane(self.radius, self.axisymmetric)


class RoundDomain(_Walled):
    """The disc or ball of given radius around the origin; a large one stands for unbounded fluid."""

    shape: Literal["round"] = Field(description=_SHAPES)
    radius: float = Field(gt=0.0, description="the radius of the container, a number > 0")

    @classmethod
    def wall_names(cls, axisymmetric: bool) -> tuple[str, ...]:
        """far."""
        return Round(1.0, axisymmetric).walls

    def container(self) -> Container:
        """The geometry."""
        return Round(self.radius, self.axisymmetric)


def _domain_kind(value: Any) -> str:
    """The shape; for a misspelt one the shape whose keys are given, which then refuses its name."""
    if not isinstance(value, dict):
        return f"<{getattr(value, 'shape', 'box')}>"
    shape = value.get("shape", "box")
    if shape not in ("box", "half-plane", "round"):
        shape = "half-plane" if "radius" in value else "box"
    return f"<{shape}>"


Domain = Annotated[
    Annotated[BoxDomain, Tag("<box>")]
    | Annotated[HalfPlaneDomain, Tag("<half-plane>")]
    | Annotated[RoundDomain, Tag("<round>")],
    Discriminator(_domain_kind),
]


def wall_velocity(wall: Wall, t: float) -> WallVelocity | None:
    """The velocity that holds at a wall at time t; None where the traction is given instead."""
    match wall:
        case tuple():
            return WallVelocity(np.array([value_at(component, t) for component in wall]), 0.0)
        case Shear():
            return WallVelocity(np.zeros(2), wall.shear)
        case _:
            return None


def wall_pressure(wall: Wall) -> float | None:
    """The outside pressure of an open wall; None where the velocity is given instead."""
    match wall:
        case "open":
            return 0.0
        case Pressure():
            return wall.pressure
        case _:
            return None


def wall_kinks(wall: Wall) -> set[float]:
    """The times at which the velocity of a wall has a kink."""
    return {time for part in wall for time in kinks(part)} if isinstance(wall, tuple) else set()
