"""A cell, periodic along some of its axes and walled across the others, and bodies in it.

Lengths are in the user's unit; `d` is 2 for discs and 3 for spheres. Images across periodic sides count like
any other body: `separation` is the vector to the nearest image.
"""

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
import scipy  # its modules load when they are used
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
BODY_BYTES = 20e3  # measured at 20 000 bodies at random
# For each kind of cell whether it is periodic along the flow, and across it.
CELLS = {"channel": (True, False), "periodic": (True, True), "box": (False, False)}


def volumes(radii: ArrayLike, dimension: int) -> Array:
    """Areas pi a^2 of discs, or volumes 4 pi a^3 / 3 of spheres."""
    factor = {2: pi, 3: 4.0 * pi / 3.0}[dimension]
    return np.asarray(factor * np.asarray(radii, dtype=np.float64) ** dimension)


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which arrangement is asked for; see `fsi pack --help`.

    Attributes:
        number: of bodies.
        fraction: of the area, in space of the volume, that they fill.
        gap: the smallest between bodies, and to walls.
        radius: the mean radius.
        cell: one of CELLS.
        aspect, seed, sizes, spread, dimension: of random arrangements.
        rows, length, angle: of the others; degrees to x.
    """

    number: int
    fraction: float
    gap: float
    radius: float = 1.0
    cell: str = "channel"
    aspect: float = 1.0
    seed: int = 1
    sizes: str = "equal"
    spread: float = 0.0
    dimension: int = 2
    rows: int = 1
    length: int = 1
    angle: float = 90.0

    @property
    def periodic(self) -> tuple[bool, ...]:
        """For each axis whether it is periodic; in space a channel is periodic along x and y."""
        along, across = CELLS[self.cell]
        return (along,) * (self.dimension - 1) + (across,)

    @property
    def disc_area(self) -> float:
        """That of one of equal discs."""
        return pi * self.radius**2

    @property
    def apart(self) -> float:
        """The distance s = 2 a + g of the centres of two neighbours."""
        return 2.0 * self.radius + self.gap


@dataclass(frozen=True, slots=True)
class SimulationCell:
    """The box from the origin to `sides`, d lengths; walls stand across the axes that are not periodic."""

    sides: tuple[float, ...]
    periodic: tuple[bool, ...]

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.sides)

    @property
    def walled(self) -> NDArray[np.intp]:
        """The axes with walls across them."""
        return np.flatnonzero(~np.array(self.periodic))

    @property
    def volume(self) -> float:
        """Area in the plane, volume in space."""
        return float(np.prod(self.sides))

    def wrapped(self, x: Array) -> Array:
        """The points (n, d) with their periodic coordinates in [0, side)."""
        sides = np.array(self.sides)
        inside = np.where(self.periodic, x - sides * np.floor(x / sides), x)
        return np.where(np.logical_and(self.periodic, inside >= sides), 0.0, inside)  # x = -1e-17 rounds up

    def separation(self, x: Array, y: Array) -> Array:
        """The vectors (n, d) from points y to the nearest images of points x."""
        sides = np.array(self.sides)
        between = x - y
        return between - np.where(self.periodic, sides * np.round(between / sides), 0.0)

    def near_pairs(self, x: Array, reach: float) -> NDArray[np.intp]:
        """Pairs (i, j), i < j, of points (n, d) no further apart than `reach`, sorted, shape (P, 2)."""
        tree = scipy.spatial.cKDTree(self.wrapped(x), boxsize=np.where(self.periodic, self.sides, 0.0))
        pairs = np.sort(tree.query_pairs(reach, output_type="ndarray").astype(np.intp), axis=1)
        order = np.lexsort((pairs[:, 1], pairs[:, 0]))
        return np.asarray(pairs[order])

    def wall_distances(self, x: Array) -> Array:
        """Distance of points (n, d) to the walls, two for each walled axis, shape (n, walls)."""
        across = x[:, self.walled]
        return np.concatenate([across, np.array(self.sides)[self.walled] - across], axis=1)


@dataclass(frozen=True, slots=True)
class Arrangement:
    """Bodies in a cell: their centres, (N, d), periodic coordinates in [0, side), and radii, (N,)."""

    cell: SimulationCell
    centres: Array
    radii: Array

    def bodies(self) -> tuple[dict[str, Any], ...]:
        """Each as an entry of [[bodies]], called disc0001 or sphere0001 and on."""
        name = {2: "disc", 3: "sphere"}[self.cell.dimension]
        both = zip(self.radii.tolist(), self.centres.tolist(), strict=True)
        return tuple(
            {"name": f"{name}{number:04d}", "radius": a, "position": tuple(centre)}
            for number, (a, centre) in enumerate(both, 1)
        )

    def fraction(self) -> float:
        """The area fraction phi (volume fraction in space)."""
        return float(volumes(self.radii, self.cell.dimension).sum() / self.cell.volume)

    def smallest_gap(self) -> float:
        """The smallest gap between bodies, their images included; infinite for one body between walls."""
        largest = float(self.radii.max())
        periodic_sides = np.array(self.cell.sides)[np.array(self.cell.periodic)]
        to_image = float(np.min(periodic_sides, initial=np.inf)) - 2.0 * largest
        reach = 4.0 * largest
        while True:
            i, j = self.cell.near_pairs(self.centres, reach).T
            between = self.cell.separation(self.centres[i], self.centres[j])
            gaps = np.linalg.norm(between, axis=1) - self.radii[i] - self.radii[j]
            smallest = min(to_image, float(gaps.min(initial=np.inf)))
            if smallest <= reach - 2.0 * largest or reach > 2.0 * sum(self.cell.sides):
                return smallest
            reach *= 2.0

    def scaled(self, factor: float) -> "Arrangement":
        """The same with all lengths times the factor."""
        cell = SimulationCell(tuple(factor * side for side in self.cell.sides), self.cell.periodic)
        return Arrangement(cell, cell.wrapped(factor * self.centres), factor * self.radii)

    def smallest_wall_gap(self) -> float:
        """The smallest gap between bodies and walls; infinite without walls."""
        return float((self.cell.wall_distances(self.centres) - self.radii[:, None]).min(initial=np.inf))
