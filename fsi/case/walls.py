"""What holds at the walls of a domain: a velocity, or a traction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple, override

import numpy as np
from pydantic import Discriminator, Field, PrivateAttr, Tag, ValidationInfo, field_validator

from fsi.bodies.configuration import Array
from fsi.case.section import (
    CaseContext,
    Geometry,
    Section,
    dimension_of,
    nearest_word,
    refuse_unknown,
    require_components,
    told,
)
from fsi.case.series import Series, kinks, value_at
from fsi.meshes.geometry.containers import Container


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


class MeanDrive(NamedTuple):
    """What drives the fluid along a channel.

    pressure_gradient: the mean dp/dx, None where it is a result; net_flux: the flux of fluid and bodies along
    x that is then given.
    """

    pressure_gradient: float | None
    net_flux: float | None


class Walled(Section):
    """What all domains have: a condition at every wall, and perhaps the user's own mesh of the shape."""

    _geometry: Geometry = PrivateAttr("planar")
    walls: dict[str, Wall] = Field(
        default={},
        validate_default=True,
        description='for each wall its velocity [u_x, u_y] (in space [u_x, u_y, u_z]), "open", '
        "{pressure = p} or {shear = rate}",
    )
    mesh: str | None = Field(
        default=None, description="the path of a mesh file of this shape, seen from the case file's folder"
    )

    @override
    def model_post_init(self, context: Any) -> None:
        """Keep the geometry of the case, which says what the container looks like."""
        if isinstance(context, CaseContext):
            self._geometry = context.geometry

    @property
    def geometry(self) -> Geometry:
        """That of the case."""
        return self._geometry

    @field_validator("walls")
    @classmethod
    def _complete(cls, walls: dict[str, Wall], info: ValidationInfo) -> dict[str, Wall]:
        geometry = told(info).geometry
        return _all_walls(walls, cls.wall_names(geometry), dimension_of(geometry))

    @classmethod
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:
        """Names of the walls of this shape."""
        raise NotImplementedError

    def mean_drive(self) -> MeanDrive:
        """The mean pressure gradient or the net flux along a channel; no gradient elsewhere."""
        return MeanDrive(0.0, None)

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
