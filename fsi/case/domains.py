"""The shapes of domains, in the order of messages: boxes, half-plane, disc or ball, tube, cell, unbounded."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self, override

import numpy as np
from pydantic import BeforeValidator, SerializeAsAny, ValidationInfo, field_validator

import fsi.case.boxes  # noqa: F401  registered first: the shape of a domain without one
from fsi.case.domain import MeanDrive, Walled, register_domain
from fsi.case.section import Geometry, Positive, dimension_of, require_components, told
from fsi.case.shaped_walls import StraightWalls
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.containers import HalfPlane, Round
from fsi.meshes.geometry.lattice import Cell
from fsi.meshes.geometry.tube import Tube
from fsi.meshes.geometry.unbounded import Unbounded


@register_domain
class HalfPlaneDomain(StraightWalls):
    """The half disc y > 0 (half ball z > 0) of large radius that stands for the half-plane (half-space)."""

    shape: Literal["half-plane"]
    radius: Positive
    """the radius of the half disc, a number > 0, some 100 body radii"""

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        return HalfPlane(1.0).walls

    @override
    def straight(self) -> Container:
        return HalfPlane(self.radius, self.geometry == "axisymmetric", dimension_of(self.geometry))

    @override
    def halved(self) -> Self:
        return self.model_copy(update={"radius": self.radius / 2.0})


@register_domain
class RoundDomain(Walled):
    """The disc or ball of given radius around the origin; a large one stands for unbounded fluid."""

    shape: Literal["round"]
    radius: Positive
    """a number > 0; the container is real where a body reaches beyond 3/8 of it, else half of it is tried"""

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        return Round(1.0).walls

    @override
    def container(self) -> Container:
        return Round(self.radius, self.geometry == "axisymmetric", dimension_of(self.geometry))

    @override
    def halved(self) -> Self:
        return self.model_copy(update={"radius": self.radius / 2.0})


@register_domain
class TubeDomain(Walled):
    """In space, the round tube about the z axis between z = -length / 2 and length / 2, closed there."""

    shape: Literal["tube"]
    radius: Positive
    """the radius of the tube, a number > 0"""
    length: Positive
    """the distance of its ends, a number > 0"""

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        return Tube(1.0, 1.0).walls

    @field_validator("shape")
    @classmethod
    def _in_space(cls, shape: str, info: ValidationInfo) -> str:
        if told(info).geometry != "spatial":
            raise ValueError('a tube lies in space; give geometry = "spatial", or on an axis a box')
        return shape

    @override
    def container(self) -> Container:
        return Tube(self.radius, self.length)


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


@register_domain
class UnboundedDomain(Walled):
    """Space without walls, for models that do not resolve a flow."""

    shape: Literal["unbounded"]

    @override
    def container(self) -> Container:
        return Unbounded(self.geometry == "axisymmetric", dimension_of(self.geometry))

    @override
    def require_fluid(self) -> None:
        raise InputError(
            'domain.shape = "unbounded": a flow is solved for in a container; give "round" with a large '
            "radius"
        )


Domain = Annotated[SerializeAsAny[Walled], BeforeValidator(Walled.registry.validate)]
