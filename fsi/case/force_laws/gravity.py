"""Weights."""

from typing import Literal, override

from pydantic import Field

from fsi.arrays import Array
from fsi.bodies.forces import Bulk
from fsi.case.force_laws.law import KINDS, ForceSection, register_force
from fsi.case.section import toml_text
from fsi.case.series import Series, Table, is_zero
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container


@register_force
class Gravity(ForceSection):
    """A weight: `F = m g`, or `F = (difference of densities) V g`, V the area of a disc or volume of a ball.

    With masses the buoyancy is not taken off.
    """

    kind: Literal["gravity"] = Field(description=KINDS)
    acceleration: tuple[Series, ...]
    """the acceleration g, [g_x, g_y] or [g_x, g_y, g_z], each a number or a table in time"""
    density_difference: float | None = None
    """the density of bodies less that of the fluid; their masses act if not given"""

    @override
    def weight(self, bulk: Bulk) -> tuple[Array, tuple[float | Table, ...]]:
        difference = self.density_difference
        return bulk.masses if difference is None else difference * bulk.volumes, self.acceleration

    @override
    def require_fit(self, key: str, container: Container, *, heavy: bool) -> None:
        here = f"{key}.acceleration = {toml_text(self.acceleration)}"
        if len(self.acceleration) != container.dimension:
            raise InputError(f"{here}: has {len(self.acceleration)} components; give {container.dimension}")
        if container.axisymmetric and not is_zero(self.acceleration[0]):
            raise InputError(f"{here}: is not along the axis; give [0.0, g_z]")
        if self.density_difference is None and not heavy:
            raise InputError(f"{here}: no body has a mass; give density_difference, or bodies a mass")
