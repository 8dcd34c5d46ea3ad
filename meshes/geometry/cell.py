"""A cell: the plane or space with a lattice of periods that moves with the mean flow."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import lengths
from fsi.meshes.geometry.curves import WallCurve, rescaled
from fsi.meshes.geometry.lattice import reduced, unit_shear
from fsi.meshes.geometry.unbounded import WithoutWalls

Vector = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Cell(WithoutWalls):
    """The plane or space with a lattice that moves with the mean flow `u = E x`.

    The lattice at time t is that of `exp(E t)` times the vectors, given by its reduced basis: a sheared
    lattice returns to itself at whole strains, and no cell is ever more oblique than it must be. A stress
    shears it besides, by a strain that no time tells.

    Attributes:
        vectors: d lattice vectors at time 0.
        gradient: E, rows of (dV_i / dx_j), without trace.
        time: t.
    """

    vectors: tuple[Vector, ...]
    gradient: tuple[Vector, ...]
    time: float = 0.0

    @property
    def dimension(self) -> int:
        """As many as vectors."""
        return len(self.vectors)

    def outline(self) -> tuple[WallCurve, ...]:
        """There are no walls."""
        return ()

    def size(self) -> float:
        """Length of the longest diagonal."""
        signs = np.array(list(product((1.0, -1.0), repeat=self.dimension - 1)))
        diagonals = np.column_stack([np.ones(len(signs)), signs]) @ self.periods
        return float(lengths(diagonals).max())

    def carried(self, e: Array, duration: float, strain: float = 0.0) -> Array:
        """Vectors e (n, d) carried along by the mean flow and by a strain: exp(E t) (1 + strain e_x e_d)."""
        E = self.mean_gradient
        if strain:
            e = e + strain * e @ unit_shear(self.dimension).T
        if self.dimension == 3:  # in a shear E^2 = 0: to the last bit the lattice returns at whole strains
            if not (E @ E).any():
                return np.asarray(e @ (np.eye(3) + duration * E).T)
            import scipy  # late: `fsi check` does without

            return np.asarray(e @ scipy.linalg.expm(duration * E).T)
        rate = np.sqrt(max(-np.linalg.det(E), 0.0))  # E has no trace: E^2 = -det(E) I
        by_E = np.sinh(rate * duration) / rate if rate > 0.0 else duration
        moved: Array = e @ (np.cosh(rate * duration) * np.eye(2) + by_E * E).T
        return moved

    @property
    def periods(self) -> Array:
        """The reduced basis at this time, (d, d)."""
        return _periods(self)

    @property
    def image_reach(self) -> float:
        """The longest diagonal of a cell of this volume is at least as long, however it is sheared.

        The squares of the diagonals have the mean sum |e_k|^2 >= d |e_1 ... e_d|^(2/d) >= d volume^(2/d).
        """
        d = self.dimension
        return float(np.sqrt(d) * self.volume ** (1.0 / d))

    def at(self, t: float, strain: float = 0.0) -> Cell:
        """The cell at time t, which a stress has strained besides since time 0."""
        strained = self.carried(np.array(self.vectors), 0.0, strain)
        return Cell(tuple(map(tuple, strained.tolist())) if strain else self.vectors, self.gradient, t)

    def sheared(self, rate: float) -> Cell:
        """The cell as it is, its time 0, sheared at that rate besides from now on."""
        if rate == 0.0:
            return self
        gradient = self.mean_gradient + rate * unit_shear(self.dimension)
        return Cell(tuple(map(tuple, self.periods.tolist())), tuple(map(tuple, gradient.tolist())))

    def scaled(self, factor: float) -> Cell:
        """All vectors times the factor."""
        larger = tuple(tuple(vector) for vector in rescaled(self.vectors, factor).tolist())
        return Cell(larger, self.gradient, self.time)

    @property
    def mean_gradient(self) -> Array:
        """E, (d, d)."""
        return np.array(self.gradient)

    @property
    def volume(self) -> float:
        """Of fluid and bodies together, in the plane an area; the flow preserves it."""
        return float(abs(np.linalg.det(np.array(self.vectors))))

    @property
    def middle(self) -> Array:
        """Half of all vectors of the reduced basis."""
        middle: Array = 0.5 * self.periods.sum(axis=0)
        return middle


@lru_cache(maxsize=8)  # a step asks for those of one cell some twenty times
def _periods(cell: Cell) -> Array:
    """The reduced basis of a cell."""
    basis = reduced(cell.carried(np.array(cell.vectors), cell.time))
    basis.flags.writeable = False
    return basis
