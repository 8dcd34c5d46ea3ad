"""Which arrangement is asked for, and what comes out: bodies in a cell."""

from dataclasses import dataclass
from math import floor, log10, pi
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fsi.arrangements.cell import SimulationCell
from fsi.arrangements.convex import ConvexShape
from fsi.arrangements.oriented import OrientedBodies
from fsi.arrays import Array
from fsi.errors import InputError

BODY_BYTES = 20e3  # measured at 20 000 bodies at random
# For each kind of cell whether it is periodic along the flow, and across it.
CELLS = {"channel": (True, False), "periodic": (True, True), "box": (False, False)}


def volumes(radii: ArrayLike, dimension: int) -> Array:
    """Areas pi a^2 of discs, or volumes 4 pi a^3 / 3 of spheres."""
    factor = {2: pi, 3: 4.0 * pi / 3.0}[dimension]
    return np.asarray(factor * np.asarray(radii, dtype=np.float64) ** dimension)


def too_large(fraction: float, what: str, largest: float) -> InputError:
    """The refusal of an area fraction, for some bodies with their gaps; with the largest, to four digits."""
    digits = 10.0 ** (3 - floor(log10(largest)))
    bound = f"the largest possible is {floor(largest * digits) / digits:g}"
    return InputError(f"area_fraction = {fraction:g}: too large for {what}; {bound}; lower it, or the gap")


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
        shape, ratio, aligned: of these in the plane: "disc", "ellipse" or "rod", length over width, and the
            angle of all to x in degrees, None for all directions.
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
    shape: str = "disc"
    ratio: float = 2.0
    aligned: float | None = None
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
class Arrangement:
    """Bodies in a cell: their centres, (N, d), periodic coordinates in [0, side), and radii, (N,).

    Bodies that are no discs have a shape and angles, (N,); then a radius is that of the disc of their area.
    """

    cell: SimulationCell
    centres: Array
    radii: Array
    shape: ConvexShape | None = None
    angles: Array | None = None

    def bodies(self) -> tuple[dict[str, Any], ...]:
        """Each as an entry of [[bodies]], called disc0001 or sphere0001 and on."""
        if (oriented := self.oriented) is not None:
            return oriented.described()
        name = {2: "disc", 3: "sphere"}[self.cell.dimension]
        both = zip(self.radii.tolist(), self.centres.tolist(), strict=True)
        return tuple(
            {"name": f"{name}{number:04d}", "radius": a, "position": tuple(centre)}
            for number, (a, centre) in enumerate(both, 1)
        )

    @property
    def oriented(self) -> OrientedBodies | None:
        """The bodies, where they are no discs."""
        if self.shape is None or self.angles is None:
            return None
        return OrientedBodies(self.cell, self.shape, self.radii, self.centres, self.angles)

    def fraction(self) -> float:
        """The area fraction phi (volume fraction in space)."""
        return float(volumes(self.radii, self.cell.dimension).sum() / self.cell.volume)

    @property
    def fraction_name(self) -> str:
        """What phi is called."""
        return {2: "area fraction", 3: "volume fraction"}[self.cell.dimension]

    def smallest_gap(self) -> float:
        """The smallest gap between bodies, their images included; infinite for one body between walls."""
        if (oriented := self.oriented) is not None:
            return oriented.smallest_gap()
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
        centres, radii = cell.wrapped(factor * self.centres), factor * self.radii
        return Arrangement(cell, centres, radii, self.shape, self.angles)

    def smallest_wall_gap(self) -> float:
        """The smallest gap between bodies and walls; infinite without walls."""
        if (oriented := self.oriented) is not None:
            return float(oriented.wall_room()[0].min(initial=np.inf))
        return float((self.cell.wall_distances(self.centres) - self.radii[:, None]).min(initial=np.inf))
