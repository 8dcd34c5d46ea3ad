"""The cell: `shape = "cell"`, periodic both ways."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, override

import numpy as np
from pydantic import Field, ValidationInfo, field_validator

from fsi.case.domain import Walled, register_domain
from fsi.case.section import Geometry, told
from fsi.meshes.geometry.containers import Container
from fsi.meshes.geometry.lattice import Cell

type Vector = tuple[float, float]


@register_domain
class CellDomain(Walled):
    """A cell of the plane, periodic along two lattice vectors, in the mean flow u = E x."""

    takes_mesh: ClassVar[bool] = False

    shape: Literal["cell"]
    vectors: tuple[Vector, Vector] = Field(description="two lattice vectors [[x, y], [x, y]] at time 0")
    shear: float = Field(default=0.0, description="the rate of the mean flow u = shear y e_x, a number")
    extension: float = Field(
        default=0.0, description="the rate of the mean flow u = extension (x e_x - y e_y), a number"
    )

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
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
    def _independent(cls, vectors: tuple[Vector, Vector], info: ValidationInfo) -> tuple[Vector, Vector]:
        if told(info).geometry != "planar":
            raise ValueError('only planar cells are periodic; give geometry = "planar"')
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

    @override
    def container(self) -> Container:
        """The geometry at time 0."""
        if self.shear:
            return Cell(self.vectors, ((0.0, self.shear), (0.0, 0.0)))
        return Cell(self.vectors, ((self.extension, 0.0), (0.0, -self.extension)))
