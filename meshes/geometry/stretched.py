"""A container of any shape with its lengths in other units."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.curves import Sphere, WallCurve, stretched
from fsi.meshes.geometry.derived import DerivedContainer


@dataclass(frozen=True, slots=True)
class Stretched(DerivedContainer):
    """Another container with all lengths times a factor: its point `factor x` is x of that.

    Attributes:
        inner: the other.
        factor: times its lengths, > 0.
    """

    factor: float

    @property
    def dimension(self) -> int:
        """As before."""
        return self.inner.dimension

    @property
    def axisymmetric(self) -> bool:
        """As before."""
        return self.inner.axisymmetric

    def distances(self, x: Array) -> Array:
        """Times the factor, shape (n, walls)."""
        return self.factor * self.inner.distances(x / self.factor)

    def normals(self, x: Array) -> Array:
        """As before, shape (n, walls, dimension)."""
        return self.inner.normals(x / self.factor)

    def size(self) -> float:
        """Times the factor."""
        return self.factor * self.inner.size()

    @property
    def volume(self) -> float:
        """Times the factor to the power of the dimension of the points."""
        return self.factor**self.dimension * self.inner.volume

    @property
    def volume_in_space(self) -> float:
        """With an axis times the third power."""
        return self.factor ** (3 if self.axisymmetric else self.dimension) * self.inner.volume_in_space

    def outline(self) -> tuple[WallCurve, ...]:
        """The same pieces, larger."""
        return tuple(stretched(curve, self.factor) for curve in self.inner.outline())

    @property
    def faces(self) -> Mapping[str, tuple[int, float]]:
        """The same axes."""
        return {name: (axis, self.factor * at) for name, (axis, at) in self.inner.faces.items()}

    @property
    def spheres(self) -> tuple[Sphere | None, ...]:
        """Larger ones."""
        larger = self.factor
        return tuple(s and Sphere(larger * s.centre, larger * s.radius) for s in self.inner.spheres)

    @property
    def plane(self) -> tuple[bool, ...]:
        """As before."""
        return self.inner.plane

    @property
    def waves(self) -> tuple[float, ...]:
        """Times the factor."""
        return tuple(self.factor * wave for wave in self.inner.waves)

    def bends(self, x: Array) -> Array:
        """Times the factor, shape (n, walls)."""
        return self.factor * self.inner.bends(x / self.factor)

    @property
    def periods(self) -> Array:
        """Times the factor."""
        return self.factor * self.inner.periods

    @property
    def image_reach(self) -> float:
        """Times the factor."""
        return self.factor * self.inner.image_reach

    @property
    def mean_gradient(self) -> Array:
        """As before: a rate."""
        return self.inner.mean_gradient

    def at(self, t: float, strain: float = 0.0) -> "Stretched":
        """The same of the other at time t."""
        return Stretched(self.inner.at(t, strain), self.factor)

    def sheared(self, rate: float) -> "Stretched":
        """The same of the other: a rate."""
        return Stretched(self.inner.sheared(rate), self.factor)

    def carried(self, e: Array, duration: float, strain: float = 0.0) -> Array:
        """As before: a linear map."""
        return self.inner.carried(e, duration, strain)

    @property
    def middle(self) -> Array:
        """Times the factor."""
        return np.asarray(self.factor * self.inner.middle)
