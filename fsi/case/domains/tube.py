"""A round tube in space."""

from collections.abc import Mapping
from typing import Any, Literal, override

from pydantic import ValidationInfo, field_validator

from fsi.case.domains.domain import Walled, register_domain
from fsi.case.section import Geometry, Positive, told
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.tube import Tube


@register_domain
class TubeDomain(Walled):
    """In space, the round tube about the z axis between z = -length / 2 and length / 2, with two ends."""

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
