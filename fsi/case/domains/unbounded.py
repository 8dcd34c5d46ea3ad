"""Space without walls."""

from typing import Literal, override

from fsi.case.domains.domain import Walled, register_domain
from fsi.case.section import dimension_of
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.unbounded import Unbounded


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
