"""Shapes r(theta) by Fourier coefficients: rough discs."""

from typing import Annotated, Literal, override

import numpy as np
from pydantic import Field, field_validator, model_validator

from fsi.arrays import Array
from fsi.case.section import Positive, unfit
from fsi.case.shapes.shape import BodyShape, register_shape
from fsi.meshes.geometry.jets import JetOf, polar

_MOST = 200
_POINTS = 16  # of a wave


@register_shape
class FourierShape(BodyShape):
    """r(theta) = radius (1 + sum over n of c_n cos n theta + s_n sin n theta)."""

    kind: Literal["fourier"]
    radius: Positive
    """the mean radius, a number > 0"""
    orders: tuple[Annotated[int, Field(ge=1, le=_MOST)], ...] = Field(min_length=1)
    """the orders n, whole numbers from 1 to 200, each once"""
    cosines: tuple[float, ...]
    """the coefficients c_n, one for each order"""
    sines: tuple[float, ...] = ()
    """the coefficients s_n, one for each order; 0 if not given"""

    @field_validator("orders")
    @classmethod
    def _each_once(cls, orders: tuple[int, ...]) -> tuple[int, ...]:
        for n in orders:
            if orders.count(n) > 1:
                raise ValueError(f"has the order {n} more than once")
        return orders

    @model_validator(mode="after")
    def _one_for_each_order(self) -> "FourierShape":
        for key, values in (("cosines", self.cosines), ("sines", self.sines)):
            if values and len(values) != len(self.orders):
                count = f"has {len(values)} coefficients for {len(self.orders)} orders"
                raise unfit(key, count, "give one for each")
        if np.abs(self._coefficients).sum() >= 1.0:
            raise unfit("cosines", "their sizes and those of the sines add up to 1 or more", "lower them")
        return self

    @property
    def _coefficients(self) -> Array:
        return np.array([self.cosines, self.sines or (0.0,) * len(self.orders)])

    @property
    @override
    def fewest(self) -> int:
        return max(super().fewest, _POINTS * max(self.orders))

    @override
    def curve(self) -> JetOf:
        n, (c, s) = np.array(self.orders, dtype=float), self.radius * self._coefficients

        def radius(theta: Array) -> tuple[Array, Array, Array]:
            cos, sin = np.cos(theta[:, None] * n), np.sin(theta[:, None] * n)
            even, odd = cos @ c + sin @ s, -sin @ (n * c) + cos @ (n * s)
            return self.radius + even, odd, -(cos @ (n**2 * c) + sin @ (n**2 * s))

        return polar(radius)
