"""Ellipses, with an axis spheroids."""

from typing import Literal, override

import numpy as np

from fsi.arrays import Array
from fsi.case.section import Positive
from fsi.case.shapes.shape import BodyShape, register_shape
from fsi.meshes.geometry.jets import Jet, JetOf


@register_shape
class Ellipse(BodyShape):
    """(x / a)^2 + (y / b)^2 = 1."""

    kind: Literal["ellipse"]
    axes: tuple[Positive, Positive]
    """the half axes [a, b], two numbers > 0; with an axis a is the largest r, and b is along z"""

    @property
    @override
    def half_axes(self) -> tuple[float, float, float]:
        a, b = self.axes
        return a, a, b

    @override
    def curve(self) -> JetOf:
        a = np.array(self.axes)

        def jet(t: Array) -> Jet:
            theta = 2.0 * np.pi * t[:, None]
            cos_sin = np.hstack([np.cos(theta), np.sin(theta)])
            turned = np.hstack([-np.sin(theta), np.cos(theta)])
            return Jet(a * cos_sin, 2.0 * np.pi * a * turned, -((2.0 * np.pi) ** 2) * a * cos_sin)

        return jet
