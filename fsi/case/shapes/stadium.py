"""Stadiums: rods with round ends."""

from typing import Literal, override

import numpy as np

from fsi.case.section import Positive
from fsi.case.shapes.shape import ShapeOfArcs, register_shape
from fsi.meshes.geometry.jets import ArcChain


@register_shape
class Stadium(ShapeOfArcs):
    """A rectangle along x with half a disc at either end: all points near to a straight line."""

    kind: Literal["stadium"]
    length: Positive
    """the length between the middles of its round ends, a number > 0"""
    radius: Positive
    """the radius of its round ends, a number > 0"""

    @property
    @override
    def chain(self) -> ArcChain:
        lengths = np.array([self.length, np.pi * self.radius] * 2)
        curvatures = np.array([0.0, 1.0 / self.radius] * 2)
        return ArcChain(lengths, curvatures, np.array([-0.5 * self.length, -self.radius]), 0.0)
