"""A cell that is periodic in all directions."""

from typing import Any, ClassVar, Literal, override

import numpy as np
from pydantic import ValidationInfo, field_validator

from fsi.case.domains.domain import MeanDrive, Walled, register_domain
from fsi.case.section import require_components, told
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container

type Vector = tuple[float, ...]


@register_domain
class CellDomain(Walled):
    """A cell of the plane or space, periodic along two or three lattice vectors, in the mean flow u = E x."""

    takes_mesh: ClassVar[bool] = False
    drives: ClassVar[tuple[str, ...]] = ("shear", "extension", "uniaxial", "stress")

    shape: Literal["cell"]
    vectors: tuple[Vector, ...]
    """two lattice vectors [[x, y], [x, y]] at time 0, in space three [x, y, z]"""
    shear: float = 0.0
    """the rate of the mean flow u = shear y e_x, in space shear z e_x, a number"""
    extension: float = 0.0
    """the rate of the mean flow u = extension (x e_x - y e_y), in space (x e_x - z e_z), a number"""
    uniaxial: float = 0.0
    """in space, the rate of the mean flow u = uniaxial (x e_x - y e_y / 2 - z e_z / 2), a number"""
    stress: float | None = None
    """the mean shear stress xy, in space xz, of fluid and bodies, a number; the rate of shear is a result"""

    @field_validator("walls", mode="before")
    @classmethod
    def _no_walls(cls, walls: Any) -> Any:
        if walls:
            raise ValueError("a cell has no walls; drop it, and give shear or extension for a mean flow")
        return walls

    @field_validator("vectors")
    @classmethod
    def _independent(cls, vectors: tuple[Vector, ...], info: ValidationInfo) -> tuple[Vector, ...]:
        d = told(info).dimension
        if told(info).geometry == "axisymmetric":
            raise ValueError('only planar and spatial cells are periodic; give geometry = "planar"')
        number = {2: "two", 3: "three"}[d]
        if len(vectors) != d:
            raise ValueError(f"{len(vectors)} vectors, where geometry has {number}; give {number}")
        for vector in vectors:
            require_components(vector, d, "a lattice vector")
        longest = np.hypot.reduce(vectors, axis=1).max()
        if not longest > 0.0 or not abs(np.linalg.det(np.array(vectors) / longest)) > 1e-9:
            flat = "parallel" if d == 2 else "coplanar"
            raise ValueError(
                f"the vectors are {flat}, or one is far too short; give {number} that span a cell"
            )
        return vectors

    @field_validator("extension", "uniaxial")
    @classmethod
    def _one_flow(cls, rate: float, info: Any) -> float:
        for other in ("shear", "extension"):
            if rate != 0.0 and info.data.get(other):
                raise ValueError(f"a rate of {other} is given too; drop one of them")
        if rate != 0.0 and info.field_name == "uniaxial" and told(info).dimension == 2:
            raise ValueError("is for space; give extension")
        return rate

    @field_validator("stress")
    @classmethod
    def _one_drive(cls, stress: float | None, info: Any) -> float | None:
        for rate in ("shear", "extension", "uniaxial"):
            if stress is not None and info.data.get(rate):
                raise ValueError(f"a rate of {rate} is given too, and here it is a result; drop one of them")
        return stress

    @override
    def mean_drive(self) -> MeanDrive:
        return MeanDrive(mean_stress=self.stress)

    @override
    def container(self) -> Container:
        d = len(self.vectors)
        E = np.zeros((d, d))
        E[0, -1] = self.shear
        E[0, 0] = self.extension + self.uniaxial
        E[-1, -1] = -self.extension
        if d == 3:
            E[[1, 2], [1, 2]] -= 0.5 * self.uniaxial
        return Cell(self.vectors, tuple(tuple(row) for row in (E + 0.0).tolist()))
