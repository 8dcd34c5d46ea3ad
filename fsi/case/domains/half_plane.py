"""A half-plane, as the half disc or half ball of large radius that stands for it."""

from collections.abc import Mapping
from typing import Any, Literal, Self, override

from fsi.case.domains.domain import register_domain
from fsi.case.section import Geometry, Positive, dimension_of
from fsi.case.shaped_walls import StraightWalls
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import HalfPlane


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
