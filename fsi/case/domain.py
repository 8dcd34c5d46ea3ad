"""The domain of a case: the container of the fluid."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag, field_validator

from fsi.case.section import Geometry, dimension_of, require_components, told
from fsi.case.walls import Walled
from fsi.meshes.geometry.containers import Box, Container, HalfPlane, Round
from fsi.periodic import CellDomain, ChannelDomain

_SHAPES = '"box", "half-plane", "round" or "cell"'


class BoxDomain(Walled):
    """The rectangle [lower, upper] with the walls left, right, bottom, top; in space also front, back."""

    shape: Literal["box"] = Field(default="box", description=_SHAPES)
    lower: tuple[float, ...] = Field(
        description="the lower left corner [x, y] (in space [x, y, z]), left of and below `upper`"
    )
    upper: tuple[float, ...] = Field(
        description="the upper right corner [x, y] (in space [x, y, z]), right of and above `lower`"
    )

    @classmethod
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:
        """left, right, front, back, bottom, top; no front and back in the plane, a cylinder has no left."""
        corner = (0.0,) * dimension_of(geometry)
        return Box(corner, corner, geometry == "axisymmetric").walls

    @field_validator("lower", "upper")
    @classmethod
    def _all_components(cls, corner: tuple[float, ...], info: Any) -> tuple[float, ...]:
        return require_components(corner, told(info).dimension, "a corner")

    @field_validator("upper")
    @classmethod
    def _right_way_round(cls, upper: tuple[float, ...], info: Any) -> tuple[float, ...]:
        lower = info.data.get("lower", (-np.inf,) * len(upper))
        if not all(low < high for low, high in zip(lower, upper, strict=True)):
            raise ValueError(f"does not lie to the right of and above lower = {list(lower)}")
        return upper

    def container(self) -> Container:
        """The geometry."""
        return Box(self.lower, self.upper, self.geometry == "axisymmetric")


class HalfPlaneDomain(Walled):
    """The half disc y > 0 (half ball z > 0) of large radius that stands for the half-plane (half-space)."""

    shape: Literal["half-plane"] = Field(description=_SHAPES)
    radius: float = Field(
        gt=0.0, description="the radius of the half disc, a number > 0, some 100 body radii"
    )

    @classmethod
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:
        """plane and far."""
        return HalfPlane(1.0, dimension=dimension_of(geometry)).walls

    def container(self) -> Container:
        """The geometry."""
        return HalfPlane(self.radius, self.geometry == "axisymmetric", dimension_of(self.geometry))


class RoundDomain(Walled):
    """The disc or ball of given radius around the origin; a large one stands for unbounded fluid."""

    shape: Literal["round"] = Field(description=_SHAPES)
    radius: float = Field(gt=0.0, description="the radius of the container, a number > 0")

    @classmethod
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:
        """far."""
        return Round(1.0, dimension=dimension_of(geometry)).walls

    def container(self) -> Container:
        """The geometry."""
        return Round(self.radius, self.geometry == "axisymmetric", dimension_of(self.geometry))


class UnboundedDomain(Walled):
    """No container: for models without a fluid that must be enclosed."""

    shape: Literal["unbounded"] = Field(description=_SHAPES)

    @classmethod
    def wall_names(cls, geometry: Geometry) -> tuple[str, ...]:  # noqa: ARG003
        """None."""
        return ()

    def container(self) -> Container:
        """The geometry."""
        return Round(np.inf, self.geometry == "axisymmetric", dimension_of(self.geometry))


def _domain_kind(value: Any) -> str:
    """The shape; for a misspelt or missing one that whose keys are given, which then refuses its name."""
    if not isinstance(value, dict):
        return "<channel>" if isinstance(value, ChannelDomain) else f"<{getattr(value, 'shape', 'box')}>"
    shape = value.get("shape", "box" if "lower" in value else None)
    if shape not in ("box", "half-plane", "round", "cell", "unbounded"):
        shape = "half-plane" if "radius" in value else "cell" if "vectors" in value else "box"
    return "<channel>" if shape == "box" and "periodic" in value else f"<{shape}>"


Domain = Annotated[
    Annotated[BoxDomain, Tag("<box>")]
    | Annotated[ChannelDomain, Tag("<channel>")]
    | Annotated[CellDomain, Tag("<cell>")]
    | Annotated[HalfPlaneDomain, Tag("<half-plane>")]
    | Annotated[RoundDomain, Tag("<round>")]
    | Annotated[UnboundedDomain, Tag("<unbounded>")],
    Discriminator(_domain_kind),
]
