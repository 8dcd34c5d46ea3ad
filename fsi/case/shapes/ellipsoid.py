"""Ellipsoids in space."""

from typing import ClassVar, Literal, override

import numpy as np

from fsi.case.section import Geometry, Positive
from fsi.case.shapes.shape import AnyShape, register_shape
from fsi.meshes.geometry.ellipsoid import Ellipsoid


@register_shape
class EllipsoidShape(AnyShape):
    """(x / a)^2 + (y / b)^2 + (z / c)^2 = 1."""

    geometries: ClassVar[tuple[Geometry, ...]] = ("spatial",)
    kind: Literal["ellipsoid"]
    axes: tuple[Positive, Positive, Positive]
    """the half axes [a, b, c], three numbers > 0"""

    @property
    @override
    def half_axes(self) -> tuple[float, float, float]:
        return self.axes

    @property
    @override
    def ellipsoid(self) -> Ellipsoid:
        return Ellipsoid(np.array(self.axes))
