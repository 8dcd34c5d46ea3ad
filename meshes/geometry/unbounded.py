"""Containers without walls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import Container


class WithoutWalls(Container):
    """What has no walls."""

    __slots__ = ()
    walls: ClassVar[tuple[str, ...]] = ()

    def distances(self, x: Array) -> Array:
        """There are none: shape (n, 0)."""
        return np.empty((len(x), 0))

    def normals(self, x: Array) -> Array:
        """There are none: shape (n, 0, dimension)."""
        return np.empty((len(x), 0, self.dimension))

    def distance_formulas(self) -> list[str]:
        """There are none."""
        return []


@dataclass(frozen=True, slots=True)
class Unbounded(WithoutWalls):
    """All of the plane or space, without walls: nothing there is meshed."""

    axisymmetric: bool = False
    dimension: int = 2

    def size(self) -> float:
        """Without a bound."""
        return np.inf

    @property
    def volume(self) -> float:
        """Without a bound."""
        return np.inf
