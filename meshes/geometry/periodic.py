"""Periodic containers: the channel, periodic along x, and the cell, periodic along two lattice vectors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fsi.meshes.geometry.containers import Array, Container, Steady
from fsi.meshes.geometry.lattice import reduced

Vector = tuple[float, float]


class _Planar:
    """A container in the plane."""

    __slots__ = ()

    @property
    def axisymmetric(self) -> bool:
        """It is not."""
        return False

    @property
    def dimension(self) -> int:
        """2."""
        return 2

    def axis(self) -> Vector:
        """Raises TypeError: only an axisymmetric container has one."""
        raise TypeError(f"{type(self).__name__} has no axis of symmetry")


@dataclass(frozen=True, slots=True)
class Channel(_Planar, Steady):
    """The strip between the walls bottom and top, periodic along x with the length of [lower, upper]."""

    lower: Vector
    upper: Vector

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of the walls."""
        return ("bottom", "top")

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """y for both; they never meet."""
        return (1, 1)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, 2) to the walls, shape (n, 2)."""
        return np.column_stack([x[:, 1] - self.lower[1], self.upper[1] - x[:, 1]])

    def size(self) -> float:
        """Length of the diagonal."""
        return float(np.hypot(*np.subtract(self.upper, self.lower)))

    @property
    def periods(self) -> Array:
        """(L, 0)."""
        return np.array([[self.upper[0] - self.lower[0], 0.0]])

    @property
    def volume(self) -> float:
        """Of fluid and bodies together: an area."""
        return float(np.prod(np.subtract(self.upper, self.lower)))

    @property
    def mean_gradient(self) -> Array:
        """No mean flow."""
        return np.zeros((2, 2))

    @property
    def middle(self) -> Array:
        """Between the corners."""
        return 0.5 * np.add(self.lower, self.upper)


@dataclass(frozen=True, slots=True)
class Cell(_Planar):
    """The plane with a lattice that moves with the mean flow `u = E x`.

    vectors: two lattice vectors at time 0; gradient: E, rows of (dV_i / dx_j), without trace; time: t. The
    lattice at time t is that of `exp(E t)` times the vectors, given by its reduced basis: a sheared lattice
    returns to itself at whole strains, and no cell is ever more oblique than it must be.
    """

    vectors: tuple[Vector, Vector]
    gradient: tuple[Vector, Vector]
    time: float = 0.0

    @property
    def walls(self) -> tuple[str, ...]:
        """It has none."""
        return ()

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """It has no corners."""
        return ()

    def distances(self, x: Array) -> Array:
        """There are no walls: shape (n, 0)."""
        return np.empty((len(x), 0))

    def size(self) -> float:
        """Length of the longer diagonal."""
        a, b = self.periods
        return float(max(np.hypot(*(a + b)), np.hypot(*(a - b))))

    def carried(self, e: Array, duration: float) -> Array:
        """Vectors e (n, 2) carried along by the mean flow: exp(E t) e."""
        E = np.array(self.gradient)
        rate = np.sqrt(max(-np.linalg.det(E), 0.0))  # E has no trace: E^2 = -det(E) I
        by_E = np.sinh(rate * duration) / rate if rate > 0.0 else duration
        moved: Array = e @ (np.cosh(rate * duration) * np.eye(2) + by_E * E).T
        return moved

    @property
    def periods(self) -> Array:
        """The reduced basis at this time, (2, 2)."""
        return reduced(self.carried(np.array(self.vectors), self.time))

    def at(self, t: float) -> Cell:
        """The cell at time t."""
        return Cell(self.vectors, self.gradient, t)

    @property
    def mean_gradient(self) -> Array:
        """E, (2, 2)."""
        return np.array(self.gradient)

    @property
    def volume(self) -> float:
        """Of fluid and bodies together, an area; the flow preserves it."""
        return float(abs(np.linalg.det(np.array(self.vectors))))

    @property
    def middle(self) -> Array:
        """Half of both vectors of the reduced basis."""
        middle: Array = 0.5 * self.periods.sum(axis=0)
        return middle


Periodic = Channel | Cell


def mean_velocity(container: Container, x: Array) -> Array:
    """The mean flow E x at points or between images, (n, 2): zero but in a cell."""
    carried: Array = x @ container.mean_gradient.T
    return carried
