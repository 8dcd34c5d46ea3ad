"""The periodic domains of a case: the channel, periodic along x, and the cell, periodic both ways."""

from __future__ import annotations

from typing import Any, Literal, override

import numpy as np
from pydantic import Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from fsi.case.section import Geometry, told
from fsi.case.walls import MeanDrive, Walled
from fsi.meshes.geometry.containers import Container
from fsi.meshes.geometry.periodic import Cell, Channel

type Vector = tuple[float, float]


class _Periodic(Walled):
    """What periodic domains have in common."""

    @field_validator("mesh")
    @classmethod
    def _no_mesh(cls, mesh: str | None) -> str | None:
        if mesh is not None:
            raise ValueError("a periodic domain is meshed by this program; drop it")
        return mesh

    @model_validator(mode="before")
    @classmethod
    def _planar(cls, data: Any, info: ValidationInfo) -> Any:
        if told(info).geometry != "planar":
            raise PydanticCustomError(
                "not_planar", 'only planar domains are periodic; give geometry = "planar"'
            )
        return data


class ChannelDomain(_Periodic):
    """The box between the walls bottom and top, periodic along x: there is no wall left or right."""

    shape: Literal["box"] = Field(default="box", description='"box"')
    periodic: tuple[Literal["x"]] = Field(
        description='the periodic directions: ["x"]; for both give shape = "cell"'
    )
    lower: Vector = Field(description="the lower left corner [x, y], left of and below `upper`")
    upper: Vector = Field(description="the upper right corner [x, y], right of and above `lower`")
    pressure_gradient: float = Field(default=0.0, description="the mean dp/dx, a number")
    net_flux: float | None = Field(
        default=None,
        description="the flux of fluid and bodies along x, a number; the pressure gradient is then a result",
    )

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:
        """bottom, top."""
        return ("bottom", "top")

    @field_validator("walls", mode="before")
    @classmethod
    def _no_sides(cls, walls: Any) -> Any:
        for side in ("left", "right"):
            if isinstance(walls, dict) and side in walls:
                raise ValueError(f"a domain periodic in x has no wall {side}; drop walls.{side} or periodic")
        return walls

    @field_validator("upper")
    @classmethod
    def _right_way_round(cls, upper: Vector, info: Any) -> Vector:
        lower = info.data.get("lower", (-np.inf, -np.inf))
        if not (lower[0] < upper[0] and lower[1] < upper[1]):
            raise ValueError(f"does not lie to the right of and above lower = {list(lower)}")
        return upper

    @field_validator("net_flux")
    @classmethod
    def _one_of_them(cls, net_flux: float | None, info: Any) -> float | None:
        if net_flux is not None and info.data.get("pressure_gradient"):
            raise ValueError("the pressure gradient is given too; drop one of them")
        return net_flux

    @override
    def mean_drive(self) -> MeanDrive:
        """As given."""
        return MeanDrive(self.pressure_gradient if self.net_flux is None else None, self.net_flux)

    def container(self) -> Container:
        """The geometry."""
        return Channel(self.lower, self.upper)


class CellDomain(_Periodic):
    """A cell of the plane, periodic along two lattice vectors, in the mean flow u = E x."""

    shape: Literal["cell"] = Field(description='"cell"')
    vectors: tuple[Vector, Vector] = Field(description="two lattice vectors [[x, y], [x, y]] at time 0")
    shear: float = Field(default=0.0, description="the rate of the mean flow u = shear y e_x, a number")
    extension: float = Field(
        default=0.0, description="the rate of the mean flow u = extension (x e_x - y e_y), a number"
    )

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:
        """None."""
        return ()

    @field_validator("walls", mode="before")
    @classmethod
    def _no_walls(cls, walls: Any) -> Any:
        if walls:
            raise ValueError("a cell has no walls; drop it, and give shear or extension for a mean flow")
        return walls

    @field_validator("vectors")
    @classmethod
    def _independent(cls, vectors: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
        area = abs(np.linalg.det(np.array(vectors)))
        longest = float(np.hypot(*np.transpose(vectors)).max())
        if not area > 1e-9 * longest * longest:
            raise ValueError("the vectors are parallel, or one is far too short; give two that span a cell")
        return vectors

    @field_validator("extension")
    @classmethod
    def _one_flow(cls, extension: float, info: Any) -> float:
        if extension != 0.0 and info.data.get("shear"):
            raise ValueError("a shear is given too; drop one of them")
        return extension

    def container(self) -> Container:
        """The geometry at time 0."""
        if self.shear:
            return Cell(self.vectors, ((0.0, self.shear), (0.0, 0.0)))
        return Cell(self.vectors, ((self.extension, 0.0), (0.0, -self.extension)))
