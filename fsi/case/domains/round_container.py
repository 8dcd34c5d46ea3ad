"""The disc or ball: `shape = "round"`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, Self, override

from fsi.case.domain import Walled, register_domain
from fsi.case.section import Geometry, Positive, dimension_of
from fsi.meshes.geometry.containers import Container, Round


@register_domain
class RoundDomain(Walled):
    """The disc or ball of given radius around the origin; a large one stands for unbounded fluid."""

    shape: Literal["round"]
    radius: Positive
    """the radius of the container, a number > 0"""

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        """far."""
        return Round(1.0).walls

    @override
    def container(self) -> Container:
        """The geometry."""
        return Round(self.radius, self.geometry == "axisymmetric", dimension_of(self.geometry))

    @override
    def halved(self) -> Self:
        """With half the radius."""
        return self.model_copy(update={"radius": self.radius / 2.0})
