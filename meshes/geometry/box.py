"""Boxes: rectangles, blocks and cylinders about an axis, perhaps periodic."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import Any, Self

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.curves import WallCurve, rescaled, segment

# Names of the walls of a box: the low and the high end along x, then along the other axes.
_FACES = {2: ("left", "right", "bottom", "top"), 3: ("left", "right", "front", "back", "bottom", "top")}


@dataclass(frozen=True, slots=True)
class Box(Container):
    """Rectangle [lower, upper] with walls left, right, bottom, top; in space also front and back.

    In space left and right are the ends in x, front and back in y, bottom and top in z.
    Axisymmetric, it is a cylinder: lower[0] is 0 and there is no wall left.

    Attributes:
        lower: the corner with the smallest coordinates, (d,).
        upper: the corner with the largest, (d,).
        axisymmetric: whether points are (r, z).
        periodic: the directions of "x", "y", "z" in which it is periodic; no walls stand across them.
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    axisymmetric: bool = False
    periodic: tuple[str, ...] = ()

    @property
    def dimension(self) -> int:
        """Of its corners."""
        return len(self.lower)

    @property
    def _ends(self) -> list[int]:
        """Which of the 2 d ends, low and high along each axis, are walls."""
        open_ends = {2 * "xyz".index(letter) + side for letter in self.periodic for side in range(2)}
        return [k for k in range(int(self.axisymmetric), 2 * self.dimension) if k not in open_ends]

    @property
    def walls(self) -> tuple[str, ...]:
        """Names of the walls."""
        return tuple(_FACES[self.dimension][k] for k in self._ends)

    @property
    def faces(self) -> Mapping[str, tuple[int, float]]:
        """Left and right across x, and so on."""
        corners = (self.lower, self.upper)
        return {_FACES[self.dimension][k]: (k // 2, corners[k % 2][k // 2]) for k in self._ends}

    def meetings(self) -> dict[tuple[int, int], Array]:
        """Walls across different axes meet, in space along an edge."""
        low_and_high = np.array([self.lower, self.upper])
        vertices = np.array(list(product((0, 1), repeat=self.dimension)))
        x, found = np.take_along_axis(low_and_high, vertices, axis=0), dict[tuple[int, int], Array]()
        for (one, k), (other, m) in combinations(enumerate(self._ends), 2):
            if k // 2 != m // 2:
                on_both = (vertices[:, k // 2] == k % 2) & (vertices[:, m // 2] == m % 2)
                found[one, other] = x[on_both]
        return found

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """The axis across each wall: x for left and right, and so on."""
        return tuple(k // 2 for k in self._ends)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to the walls, shape (n, walls)."""
        low = x - np.asarray(self.lower)
        high = np.asarray(self.upper) - x
        return np.stack([low, high], axis=2).reshape(len(x), 2 * self.dimension)[:, self._ends]

    def normals(self, x: Array) -> Array:
        """The same at all points."""
        e = np.eye(self.dimension)
        rows = np.array([e[k // 2] if k % 2 == 0 else -e[k // 2] for k in self._ends])
        return np.broadcast_to(rows.reshape(-1, self.dimension), (len(x), len(rows), self.dimension))

    def outline(self) -> tuple[WallCurve, ...]:
        """A segment for each wall."""
        (x0, y0), (x1, y1) = self.lower, self.upper
        ends = {
            "left": ((x0, y1), (x0, y0)),
            "right": ((x1, y0), (x1, y1)),
            "bottom": ((x0, y0), (x1, y0)),
            "top": ((x1, y1), (x0, y1)),
        }
        return tuple(segment(k, *ends[wall]) for k, wall in enumerate(self.walls))

    def wall_fluxes(self) -> Array:
        """Each wall's area along its axis, times x_j in its middle."""
        sides = np.subtract(self.upper, self.lower)
        areas = sides.prod() / sides
        if self.axisymmetric:
            radius, height = self.upper[0], sides[1]
            areas = np.pi * np.array([2.0 * radius * height, radius**2])
        fluxes = np.zeros((len(self.walls), self.dimension, self.dimension + 1))
        for flux, k in zip(fluxes, self._ends, strict=True):
            axis, middle = k // 2, self.middle
            middle[axis] = self.upper[axis] if k % 2 else self.lower[axis]
            flux[axis] = (areas[axis] if k % 2 else -areas[axis]) * np.array([1.0, *middle])
        return fluxes

    def size(self) -> float:
        """Length of the diagonal."""
        return float(np.hypot.reduce(np.subtract(self.upper, self.lower)))

    @property
    def volume(self) -> float:
        """Product of the sides."""
        return float(np.prod(np.subtract(self.upper, self.lower)))

    @property
    def volume_in_space(self) -> float:
        """With an axis of the cylinder, pi r^2 h."""
        return float(np.pi * self.upper[0] * self.volume) if self.axisymmetric else self.volume

    @property
    def periods(self) -> Array:
        """The sides along the periodic directions."""
        sides = np.diag(np.subtract(self.upper, self.lower))
        periods: Array = sides[["xyz".index(letter) for letter in self.periodic]]
        return periods

    @property
    def image_reach(self) -> float:
        """Its size, if it is periodic."""
        return self.size() if self.periodic else np.inf

    def scaled(self, factor: float) -> Self:
        """Both corners times the factor."""
        lower, upper = (tuple(rescaled(corner, factor).tolist()) for corner in (self.lower, self.upper))
        return replace(self, lower=lower, upper=upper)

    def seen_from(self, origin: Array) -> Self | None:
        """Both corners less the origin; none with periods, whose pressure has its zero at the origin."""
        if len(self.periods):
            return None
        lower, upper = (tuple(np.subtract(corner, origin).tolist()) for corner in (self.lower, self.upper))
        return replace(self, lower=lower, upper=upper)

    def solid(self, kernel: Any) -> int:
        """A box."""
        return int(kernel.addBox(*self.lower, *np.subtract(self.upper, self.lower)))

    def distance_formulas(self) -> list[str]:
        """Differences of a coordinate."""
        sides = zip("xyz", self.lower, self.upper, strict=True)
        every = [side for s, low, high in sides for side in (f"({s}-({low!r}))", f"(({high!r})-{s})")]
        return [every[k] for k in self._ends]

    @property
    def middle(self) -> Array:
        """Between the corners."""
        return 0.5 * np.add(self.lower, self.upper)
