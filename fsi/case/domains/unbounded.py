"""No container: `shape = "unbounded"`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, override

from fsi.case.domain import Walled, register_domain
from fsi.case.section import Geometry, dimension_of
from fsi.errors import InputError
from fsi.meshes.geometry.containers import Container, Unbounded


@register_domain
class UnboundedDomain(Walled):
    """Space without walls, for models that do not resolve a flow."""

    shape: Literal["unbounded"]

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        """None."""
        return ()

    @override
    def container(self) -> Container:
        """The geometry."""
        return Unbounded(self.geometry == "axisymmetric", dimension_of(self.geometry))

    @override
    def require_fluid(self) -> None:
        raise InputError(
            'domain.shape = "unbounded": a flow is solved for in a container; give "round" with a large '
            "radius"
        )
