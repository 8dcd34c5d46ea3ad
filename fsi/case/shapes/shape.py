"""The key `shape` of [[bodies]]: what bodies look like that are not discs or spheres.

One more shape is one file here: a section under `@register_shape` with its curve. Files of this room are
found by themselves; from outside the decorator alone does.
"""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property, lru_cache
from math import nan
from typing import Annotated, Any, ClassVar, override

from pydantic import BeforeValidator, SerializeAsAny, ValidationInfo

from fsi.case.section import Registered, Registry, told
from fsi.meshes.geometry.jets import ArcChain, JetOf
from fsi.meshes.geometry.outline import FEWEST, Outline
from fsi.meshes.geometry.revolved import BodyOfRevolution


class BodyShape(Registered):
    """The shape of a body at the angle 0; its position is the centre of its area.

    With an axis a curve in (r, z) that is symmetric about r = 0: the body is what it encloses when it turns
    around the axis, its position the centre of that volume.
    """

    registry: ClassVar[Registry[Any]] = Registry("kind")

    @abstractmethod
    def curve(self) -> JetOf:
        """Once around it counterclockwise for 0 <= t <= 1, with a tangent that turns smoothly."""

    @property
    def joints(self) -> tuple[float, ...]:
        """The t where its curvature or a higher derivative jumps, ascending; nodes of meshes stand there."""
        return ()

    @property
    def half_axes(self) -> tuple[float, float, float]:
        """Of the ellipsoid that it is if it turns around an axis, that last; NaN if it is none."""
        return nan, nan, nan

    @property
    def fewest(self) -> int:
        """How many points of it overlook none of its waves."""
        return FEWEST

    @cached_property
    def outline(self) -> Outline:
        """The same as geometry."""
        return _outline(self)

    def revolved(self, angle: float) -> BodyOfRevolution:
        """Turned by an angle in the plane of (r, z) and then around the axis."""
        return BodyOfRevolution.about_axis(self.curve(), self.joints, angle)


@lru_cache(maxsize=256)
def _outline(shape: BodyShape) -> Outline:
    """One for all bodies of a suspension that are alike."""
    return Outline.of(shape.curve(), shape.joints, shape.fewest)


class ShapeOfArcs(BodyShape):
    """One of straight sides and arcs of circles."""

    @property
    @abstractmethod
    def chain(self) -> ArcChain:
        """Its sides and arcs, one after the other."""

    @property
    @override
    def joints(self) -> tuple[float, ...]:
        return self.chain.joints

    @override
    def curve(self) -> JetOf:
        return self.chain


register_shape = BodyShape.registry.register


def _of_plane(value: Any, info: ValidationInfo) -> Any:
    """The section that a table describes. Raises ValueError in space."""
    if value is None:
        return None
    if told(info).geometry == "spatial":
        raise ValueError('is for geometry = "planar" and "axisymmetric"; drop it')
    shape: BodyShape = BodyShape.registry.validate(value, info)
    if shape.outline.area <= 0.0:
        raise ValueError("runs clockwise; turn the order of its points round")
    if shape.outline.crosses_itself():
        raise ValueError("crosses itself; give a curve without crossings")
    return shape


Shape = Annotated[SerializeAsAny[BodyShape], BeforeValidator(_of_plane)]
