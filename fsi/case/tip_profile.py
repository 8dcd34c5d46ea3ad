"""The profile of tips, of bodies and of walls."""

from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array


@dataclass(frozen=True, slots=True)
class TipProfile:
    """y = length (x / length)^(1 + alpha) at x >= 0.

    Attributes:
        length: its unit, > 0.
        alpha: in (0, 1]; below 1 its curvature is infinite at x = 0.
    """

    length: float
    alpha: float

    def slope(self, x: float) -> float:
        """y' at x."""
        return float((1.0 + self.alpha) * (x / self.length) ** self.alpha)

    def at(self, x: Array) -> tuple[Array, Array, Array]:
        """y, y' and y'' at x (n,), each (n,)."""
        s, power = x / self.length, 1.0 + self.alpha
        with np.errstate(divide="ignore"):
            bend = power * self.alpha / self.length * s ** (self.alpha - 1.0)
        return self.length * s**power, power * s**self.alpha, bend
