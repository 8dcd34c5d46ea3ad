"""Stadiums: rods with round ends."""

from typing import Literal, override

import numpy as np

from fsi.case.section import Positive
from fsi.case.shapes.shape import BodyShape, register_shape
from fsi.meshes.geometry.jets import ArcChain, JetOf


@register_shape
class Stadium(BodyShape):
    """A rectangle along x with half a disc at either end: all points near to a straight line."""

    kind: Literal["stadium"]
    length: Positive
    """the length between the middles of its round ends, a number > 0"""
    radius: Positive
    """the radius of its round ends, a number > 0"""

    @property
    def _chain(self) -> ArcChain:
        lengths = np.array([self.length, np.pi * self.radius] * 2)
        curvatures = np.array([0.0, 1.0 / self.radius] * 2)
        return ArcChain(lengths, curvatures, np.array([-0.5 * self.length, -self.radius]), 0.0)

    @property
    @override
    def joints(self) -> tuple[float, ...]:
        return self._chain.joints

    @override
    def curve(self) -> JetOf:
        return self._chain
