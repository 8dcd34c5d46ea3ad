"""What has a radius: `shape = "half-plane"` and `shape = "round"`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, Self, override

from pydantic import Field

from fsi.case.domain import Walled, register_domain
from fsi.case.section import Geometry, dimension_of
from fsi.meshes.geometry.containers import Container, HalfPlane, Round


class _RadialDomain(Walled):
    """A container of some radius around the origin."""

    geometry_of: ClassVar[type[HalfPlane] | type[Round]]

    radius: float = Field(gt=0.0, description="the radius of the container, a number > 0")

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        return cls.geometry_of.walls

    @override
    def container(self) -> Container:
        return self.geometry_of(self.radius, self.geometry == "axisymmetric", dimension_of(self.geometry))

    @override
    def halved(self) -> Self:
        return self.model_copy(update={"radius": self.radius / 2.0})


@register_domain
class HalfPlaneDomain(_RadialDomain):
    """The half disc y > 0 (half ball z > 0) of large radius that stands for the half-plane (half-space)."""

    geometry_of = HalfPlane

    shape: Literal["half-plane"]
    radius: float = Field(
        gt=0.0, description="the radius of the half disc, a number > 0, some 100 body radii"
    )


@register_domain
class RoundDomain(_RadialDomain):
    """The disc or ball of given radius around the origin; a large one stands for unbounded fluid."""

    geometry_of = Round

    shape: Literal["round"]
