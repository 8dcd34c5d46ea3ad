"""The key `shape` of [[bodies]]: what bodies look like that are not discs or spheres.

One more shape in the plane or on an axis is one file here: a section under `@register_shape` with its curve.
Files of this room are found by themselves; from outside the decorator alone does.
"""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property, lru_cache
from math import nan
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, override

import numpy as np
from pydantic import BeforeValidator, SerializeAsAny, ValidationInfo

from fsi.case.registry import Registered, Registry, blamed_on
from fsi.case.section import Geometry, told
from fsi.meshes.geometry.jets import CONSISTENT, ArcChain, JetOf

if TYPE_CHECKING:
    from fsi.meshes.geometry.ellipsoid import Ellipsoid
    from fsi.meshes.geometry.outline import Outline
    from fsi.meshes.geometry.revolved import BodyOfRevolution


class AnyShape(Registered):
    """The shape of a body at the angle 0.

    Of `outline`, `revolved` and `ellipsoid` it has what `geometries` ask for.

    Attributes:
        geometries: of the cases in which bodies look so.
    """

    registry: ClassVar[Registry[Any]] = Registry("kind", __package__)
    geometries: ClassVar[tuple[Geometry, ...]]

    @property
    def half_axes(self) -> tuple[float, float, float]:
        """Of the ellipsoid that it is, if it turns around an axis that last; NaN if it is none."""
        return nan, nan, nan

    @property
    def outline(self) -> Outline:
        """In the plane."""
        raise NotImplementedError

    def revolved(self, angle: float) -> BodyOfRevolution:
        """Turned by an angle in the plane of (r, z) and then around the axis."""
        raise NotImplementedError

    @property
    def ellipsoid(self) -> Ellipsoid:
        """In space."""
        raise NotImplementedError

    def check(self) -> None:
        """Raise ValueError where no body looks so."""


SMALLEST = 1e-60  # size of a shape, whose fourth power is a number
CLOSED = 1e-6  # of its size: so near to each other its ends are one
BEFORE_END = float(np.nextafter(1.0, 0.0))  # the last t: a formula may count it around


class BodyShape(AnyShape):
    """A shape by its curve; the position of the body is the centre of its area.

    With an axis a curve in (r, z) that is symmetric about r = 0: the body is what it encloses when it turns
    around the axis, its position the centre of that volume.
    """

    geometries: ClassVar[tuple[Geometry, ...]] = ("planar", "axisymmetric")

    @abstractmethod
    def curve(self) -> JetOf:
        """Once around it counterclockwise for 0 <= t <= 1, with a tangent that turns smoothly."""

    @property
    def joints(self) -> tuple[float, ...]:
        """The t where its curvature or a higher derivative jumps, ascending; nodes of meshes stand there."""
        return ()

    @property
    def fewest(self) -> int:
        """How many points of it overlook none of its waves."""
        from fsi.meshes.geometry.closed_curve import FEWEST

        return FEWEST

    @cached_property
    @override
    def outline(self) -> Outline:
        return _outline(self)

    @override
    def revolved(self, angle: float) -> BodyOfRevolution:
        from fsi.meshes.geometry.revolved import BodyOfRevolution

        return BodyOfRevolution.about_axis(self.outline, angle)

    @override
    def check(self) -> None:
        t = np.linspace(0.0, BEFORE_END, 11)
        with np.errstate(all="ignore"):
            x = self.curve()(t).x
        if len(nowhere := t[np.isnan(x).any(axis=1)]):
            raise ValueError(f"has points that are NaN, the first at t = {nowhere[0]:.3g}; correct its curve")
        size = float(np.ptp(x, axis=0).max())
        if not SMALLEST < size < 1.0 / SMALLEST:
            raise ValueError("is too small or too large for numbers; give lengths in another unit")
        if np.hypot(*(x[-1] - x[0])) > CLOSED * size:
            raise ValueError("does not close; give a curve whose points at t = 0 and t = 1 are the same")
        with np.errstate(all="ignore"):
            inconsistency = self.outline.inconsistency
        if not inconsistency <= CONSISTENT:
            raise ValueError(
                "has derivatives that are not those of its points; correct its curve, or have `fewest` of it "
                "overlook no wave"
            )
        if not self.outline.is_resolved:
            raise ValueError("is too slender or too jagged; give one that is rounder")
        if self.outline.area <= 0.0:
            raise ValueError("runs clockwise; turn the order of its points round")
        if self.outline.crosses_itself():
            raise ValueError("crosses itself; give a curve without crossings")


@lru_cache(maxsize=256)
def _outline(shape: BodyShape) -> Outline:
    """One for all bodies of a suspension that are alike."""
    from fsi.meshes.geometry.outline import Outline

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


register_shape = AnyShape.registry.register


def _of_case(value: Any, info: ValidationInfo) -> Any:
    """The section that a table describes. Raises ValueError: the case has no bodies that look so."""
    if value is None:
        return None
    shape: AnyShape = AnyShape.registry.validate(value, info)
    if told(info).geometry not in shape.geometries:
        words = " and ".join(f'"{word}"' for word in shape.geometries)
        raise ValueError(f"is for geometry = {words}; give another kind, or a radius")
    with blamed_on(shape):
        shape.check()
    return shape


Shape = Annotated[SerializeAsAny[AnyShape], BeforeValidator(_of_case)]
