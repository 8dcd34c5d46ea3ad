"""A round container: a disc, or a ball."""

from collections.abc import Mapping
from typing import Any, Literal, Self, override

from fsi.case.domains.domain import Walled, register_domain
from fsi.case.section import Geometry, Positive, dimension_of
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.round import Round


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
