"""The velocity of the fluid at a wall: a linear flow, `u = u_0 + G x`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array


@dataclass(frozen=True, slots=True, eq=False)
class WallVelocity:
    """The linear flow of an incompressible fluid that is given on a wall, `u = u_0 + G x`.

    Attributes:
        velocity: u_0, (d,).
        gradient: G, rows of du_i/dx_j, (d, d); in the plane and in space its trace is zero.
    """

    velocity: Array
    gradient: Array

    @classmethod
    def uniform(cls, velocity: Sequence[float]) -> Self:
        """That of a wall that moves without turning."""
        return cls(np.array(velocity), np.zeros((len(velocity), len(velocity))))

    def at(self, x: Array) -> Array:
        """u at points (..., d), (..., d)."""
        u: Array = self.velocity + x @ self.gradient.T
        return u

    def __str__(self) -> str:
        """Its u_0, and `+ G x` where there is such a part."""
        part = f" + {self.gradient.tolist()} x" if self.gradient.any() else ""
        return f"{self.velocity.tolist()}{part}"

    @property
    def is_zero(self) -> bool:
        """Whether it is zero everywhere."""
        return not self.velocity.any() and not self.gradient.any()

    @property
    def shear(self) -> float:
        """The rate of a shear flow `u_x = shear h`, h the last coordinate; 0 of all other flows."""
        others = self.gradient.copy()
        others[0, -1] = 0.0
        return 0.0 if others.any() else float(self.gradient[0, -1])

    @property
    def about_axis(self) -> bool:
        """Whether G x is, with points (r, z), a flow about the axis: one like (-r / 2, z)."""
        (rr, rz), (zr, zz) = self.gradient
        return bool(rz == 0.0 and zr == 0.0 and zz == -2.0 * rr)

    def is_uniform_across(self, axis: int) -> bool:
        """Whether it is one velocity all over any plane wall across that axis."""
        return not np.delete(self.gradient, axis, axis=1).any()


@dataclass(frozen=True, slots=True)
class WallVelocities:
    """Those of all walls in order; at rest where nothing is given, as where a wall is open."""

    of_walls: tuple[WallVelocity, ...]

    @classmethod
    def given(cls, walls: Sequence[str], velocities: Mapping[str, WallVelocity], dimension: int) -> Self:
        """Of walls with these names."""
        rest = WallVelocity.uniform([0.0] * dimension)
        return cls(tuple(velocities.get(name, rest) for name in walls))

    def at(self, walls: NDArray[np.intp], x: Array) -> Array:
        """u of walls (n,) at points on them (n, d), (n, d)."""
        u = np.empty_like(x)
        for wall in np.unique(walls):
            u[walls == wall] = self.of_walls[wall].at(x[walls == wall])
        return u
