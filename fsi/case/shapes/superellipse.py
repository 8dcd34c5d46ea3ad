"""Superellipses: between ellipses and rectangles."""

from typing import Literal, override

import numpy as np
from pydantic import Field

from fsi.arrays import Array
from fsi.case.section import Positive
from fsi.case.shapes.shape import BodyShape, register_shape
from fsi.meshes.geometry.jets import JetOf, polar


@register_shape
class Superellipse(BodyShape):
    """|x / a|^n + |y / b|^n = 1, an ellipse for n = 2."""

    kind: Literal["superellipse"]
    axes: tuple[Positive, Positive]
    """the half axes [a, b], two numbers > 0"""
    exponent: float = Field(ge=2.0, le=20.0)
    """the exponent n, a number from 2 to 20"""

    @property
    @override
    def joints(self) -> tuple[float, ...]:
        return (0.0, 0.25, 0.5, 0.75)

    @override
    def curve(self) -> JetOf:
        n, (a, b) = self.exponent, self.axes

        def radius(theta: Array) -> tuple[Array, Array, Array]:
            c, s = np.cos(theta), np.sin(theta)
            A, B = np.abs(c) ** (n - 2.0) / a**n, np.abs(s) ** (n - 2.0) / b**n
            # u = A c^2 + B s^2 with A ~ |c|^(n - 2), so that r = u^(-1/n).
            u, du = A * c**2 + B * s**2, n * (B - A) * s * c
            ddu = n * ((n - 1.0) * (A * s**2 + B * c**2) - u)
            r = u ** (-1.0 / n)
            dr = -r * du / (n * u)
            ddr = -r * ddu / (n * u) + (1.0 / n + 1.0) * r * du**2 / (n * u**2)
            return r, dr, ddr

        return polar(radius)
