"""The domain of a case: the container of the fluid and what holds at its walls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag, field_validator

from fsi.bodies import Array
from fsi.geometry import Geometry, dimension_of, require_components
from fsi.section import Section, nearest_word, refuse_unknown
from fsi.series import Series, kinks, value_at
from meshes.geometry import Box, Container, HalfPlane, Round


@dataclass(frozen=True, slots=True)
class WallVelocity:
    """The velocity of the fluid at a wall, `u = velocity + shear h e_x`; velocity has shape (d,).

    h is the last coordinate, y in the plane and z in space.
    """

    velocity: Array
    shear: float


class Pressure(Section):
    """An open wall: the traction there is `sigma n = -pressure n`."""

    pressure: float = Field(description="the pressure outside an open wall, a number")


class Shear(Section):
    """A wall on which the fluid has the shear flow `u = shear y e_x`, in space `shear z e_x`."""

    shear: float = Field(description="the shear rate of the flow u_x = shear y (in space shear z), a number")


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
    | Annotated[tuple[Series, ...], Tag("<velocity>")]
    | Annotated[Pressure, Tag("<pressure>")]
    | Annotated[Shear, Tag("<shear>")],
    Discriminator(_wall_kind),
]

_SHAPES = '"box", "half-plane" or "round"'


class _Walled(Section):
    """What all domains have: a condition at every wall, and perhaps the user's own mesh of the shape."""

    geometry: Geometry = Field(default="planar", alias="<geometry>", exclude=True)
    walls: dict[str, Wall] = Field(
        default={},
        validate_default=True,
        description='for each wall its velocity [u_x, u_y] (in space [u_x, u_y, u_z]), "open", '
        "{pressure = p} or {shear = rate}",
    )
    mesh: str | None = Field(
        default=None, description="the path of a mesh file of this shape, seen from the case file's folder"
    )

    @field_validator("walls")
    @classmethod
    def _complete(cls, walls: dict[str, Wall], info: Any) -> dict[str, Wall]:
        geometry: Geometry = info.data["geometry"]
        return _all_walls(walls, cls.wall_names(geometry), dimension_of(geometry))

    @classmethod
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:
        """Names of the walls of this shape."""
        raise NotImplementedError

    def container(self) -> Container:
        """The geometry."""
        raise NotImplementedError


def _all_walls(given: dict[str, Wall], names: tuple[str, ...], dimension: int) -> dict[str, Wall]:
    """The conditions of all walls in the container's order, at rest where none is given."""
    for name, wall in given.items():
        refuse_unknown(name, names)
        if isinstance(wall, tuple):
            require_components(wall, dimension, f"the velocity of {name}")
    return {name: given.get(name, (0.0,) * dimension) for name in names}


class BoxDomain(_Walled):
    """The rectangle [lower, upper] with the walls left, right, bottom, top; in space also front, back."""

    shape: Literal["box"] = Field(default="box", description=_SHAPES)
    lower: tuple[float, ...] = Field(
        description="the lower left corner [x, y] (in space [x, y, z]), left of and below `upper`"
    )
    upper: tuple[float, ...] = Field(
        description="the upper right corner [x, y] (in space [x, y, z]), right of and above `lower`"
    )

    @classmethod
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:
        """left, right, front, back, bottom, top; no front and back in the plane, a cylinder has no left."""
        corner = (0.0,) * dimension_of(geometry)
        return Box(corner, corner, geometry == "axisymmetric").walls

    @field_validator("lower", "upper")
    @classmethod
    def _all_components(cls, corner: tuple[float, ...], info: Any) -> tuple[float, ...]:
        return require_components(corner, dimension_of(info.data["geometry"]), "a corner")

    @field_validator("upper")
    @classmethod
    def _right_way_round(cls, upper: tuple[float, ...], info: Any) -> tuple[float, ...]:
        lower = info.data.get("lower", (-np.inf,) * len(upper))
        if not all(low < high for low, high in zip(lower, upper, strict=True)):
            raise ValueError(f"does not lie to the right of and above lower = {list(lower)}")
        return upper

    def container(self) -> Container:
        """The geometry."""
        return Box(self.lower, self.upper, self.geometry == "axisymmetric")


class HalfPlaneDomain(_Walled):
    """The half disc y > 0 (half ball z > 0) of large radius that stands for the half-plane (half-space)."""

    shape: Literal["half-plane"] = Field(description=_SHAPES)
    radius: float = Field(
        gt=0.0, description="the radius of the half disc, a number > 0, some 100 body radii"
    )

    @classmethod
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:
        """plane and far."""
        return HalfPlane(1.0, dimension=dimension_of(geometry)).walls

    def container(self) -> Container:
        """The geometry."""
        return HalfPlane(self.radius, self.geometry == "axisymmetric", dimension_of(self.geometry))


class RoundDomain(_Walled):
    """The disc or ball of given radius around the origin; a large one stands for unbounded fluid."""

    shape: Literal["round"] = Field(description=_SHAPES)
    radius: float = Field(gt=0.0, description="the radius of the container, a number > 0")

    @classmethod
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:
        """far."""
        return Round(1.0, dimension=dimension_of(geometry)).walls

    def container(self) -> Container:
        """The geometry."""
        return Round(self.radius, self.geometry == "axisymmetric", dimension_of(self.geometry))


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


def wall_velocity(wall: Wall, t: float, dimension: int) -> WallVelocity | None:
    """The velocity that holds at a wall at time t; None where the traction is given instead."""
    match wall:
        case tuple():
            return WallVelocity(np.array([value_at(component, t) for component in wall]), 0.0)
        case Shear():
            return WallVelocity(np.zeros(dimension), wall.shear)
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
