"""The half-plane: `shape = "half-plane"`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, Self, override

from fsi.case.domain import Walled, register_domain
from fsi.case.section import Geometry, Positive, dimension_of
from fsi.meshes.geometry.containers import Container, HalfPlane


@register_domain
class HalfPlaneDomain(Walled):
    """The half disc y > 0 (half ball z > 0) of large radius that stands for the half-plane (half-space)."""

    shape: Literal["half-plane"]
    radius: Positive
    """the radius of the half disc, a number > 0, some 100 body radii"""

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        """plane and far."""
        return HalfPlane(1.0).walls

    @override
    def container(self) -> Container:
        """The geometry."""
        return HalfPlane(self.radius, self.geometry == "axisymmetric", dimension_of(self.geometry))

    @override
    def halved(self) -> Self:
        """With half the radius."""
        return self.model_copy(update={"radius": self.radius / 2.0})
