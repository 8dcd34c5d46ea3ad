"""The containers with walls: boxes, round ones, half-planes; see `container` for what each answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import Any, ClassVar, Self

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import Container, lengths
from fsi.meshes.geometry.curves import Sphere, WallCurve, arc, rescaled, segment

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
        """Each wall's area along its axis; h n_x is that at half the height."""
        sides = np.subtract(self.upper, self.lower)
        areas = sides.prod() / sides
        if self.axisymmetric:
            radius, height = self.upper[0], sides[1]
            areas = np.pi * np.array([2.0 * radius * height, radius**2])
        rows = np.zeros((len(self.walls), self.dimension + 1))
        for row, k in zip(rows, self._ends, strict=True):
            row[k // 2] = areas[k // 2] if k % 2 else -areas[k // 2]
        rows[:, -1] = 0.5 * (self.lower[-1] + self.upper[-1]) * rows[:, 0]
        return rows

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


@dataclass(frozen=True, slots=True)
class Round(Container):
    """Disc |x| < radius with the one wall `far`; axisymmetric, or with dimension = 3, a ball.

    A small one is a round container; a large one stands for unbounded fluid.
    """

    radius: float
    axisymmetric: bool = False
    dimension: int = 2
    walls: ClassVar[tuple[str, ...]] = ("far",)

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """It has no corners."""
        return (0,)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to the arc, shape (n, 1)."""
        return self.radius - lengths(x)[:, None]

    def normals(self, x: Array) -> Array:
        """Towards the origin; zero there, where every direction is as good."""
        length = np.linalg.norm(x, axis=1, keepdims=True)
        inward: Array = -x / np.where(length > 0.0, length, 1.0)
        return inward[:, None]

    def outline(self) -> tuple[WallCurve, ...]:
        """Two arcs, with an axis the right one."""
        halves = [(-0.5, 0.5)] if self.axisymmetric else [(-0.5, 0.5), (0.5, 1.5)]
        return tuple(arc(0, self.radius, start * np.pi, end * np.pi) for start, end in halves)

    @property
    def spheres(self) -> tuple[Sphere | None, ...]:
        """Its only or last wall is round."""
        return *(None for _ in self.walls[1:]), Sphere(np.zeros(self.dimension), self.radius)

    def wall_fluxes(self) -> Array:
        """A uniform flow and a shear flow leave as they enter."""
        return np.zeros((1, self.dimension + 1))

    def size(self) -> float:
        """Diameter."""
        return 2.0 * self.radius

    @property
    def volume(self) -> float:
        """Of the whole disc or ball, with an axis of half the disc."""
        whole = np.pi * self.radius**2 if self.dimension == 2 else 4.0 / 3.0 * np.pi * self.radius**3
        return float(whole) / (2.0 if self.axisymmetric else 1.0)

    @property
    def volume_in_space(self) -> float:
        """With an axis of a ball, or half of one."""
        return replace(self, axisymmetric=False, dimension=3).volume if self.axisymmetric else self.volume

    def scaled(self, factor: float) -> Self:
        """The radius times the factor."""
        return replace(self, radius=float(rescaled(self.radius, factor)))

    def solid(self, kernel: Any) -> int:
        """A ball."""
        return int(kernel.addSphere(0.0, 0.0, 0.0, self.radius))

    def distance_formulas(self) -> list[str]:
        """The radius less the distance from the origin."""
        return [f"({self.radius!r}-sqrt(x^2+y^2+z^2))"]


@dataclass(frozen=True, slots=True)
class HalfPlane(Round):
    """Half disc y > 0, |x| < radius, that stands for the half-plane above the wall `plane` (y = 0).

    The arc `far` carries the flow at infinity, at rest if not given. What the finite radius
    changes (the truncation) decays like (a / radius)^2 or faster and is reported by `fsi solve`.
    Axisymmetric, or with dimension = 3 and z for y, it is a half ball.
    """

    walls: ClassVar[tuple[str, ...]] = ("plane", "far")
    far_walls: ClassVar[tuple[str, ...]] = ("far",)

    def meetings(self) -> dict[tuple[int, int], Array]:
        """Plane and arc meet at its ends, in space on a circle: one point of it."""
        return {(0, 1): np.array([[self.radius, 0.0, 0.0]])} if self.dimension == 3 else Round.meetings(self)

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """The last axis for the plane, x for the arc where it meets the plane."""
        return (self.dimension - 1, 0)

    def distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to the plane and to the arc, shape (n, 2)."""
        return np.column_stack([x[:, -1], Round.distances(self, x)])

    def normals(self, x: Array) -> Array:
        """Upwards from the plane, towards the origin from the arc."""
        upwards = np.broadcast_to(np.eye(self.dimension)[-1], x.shape)
        return np.concatenate([upwards[:, None], Round.normals(self, x)], axis=1)

    def outline(self) -> tuple[WallCurve, ...]:
        """From the left end of the plane to the right, and back on the arc; with an axis half of each."""
        left, turn = (0.0, 0.5 * np.pi) if self.axisymmetric else (-self.radius, np.pi)
        return segment(0, (left, 0.0), (self.radius, 0.0)), arc(1, self.radius, 0.0, turn)

    def wall_fluxes(self) -> Array:
        """What enters through the plane leaves through the arc."""
        disc = self.axisymmetric or self.dimension == 3
        rows = np.zeros((2, self.dimension + 1))
        rows[1, -2] = np.pi * self.radius**2 if disc else 2.0 * self.radius
        rows[0] = -rows[1]
        return rows

    @property
    def volume(self) -> float:
        """Of the half disc, the quarter of it, or the half ball."""
        return Round(self.radius, self.axisymmetric, self.dimension).volume / 2.0

    def solid(self, kernel: Any) -> int:
        """The northern half of a ball."""
        return int(kernel.addSphere(0.0, 0.0, 0.0, self.radius, angle1=0.0))

    def distance_formulas(self) -> list[str]:
        """z, and the radius less the distance from the origin."""
        return ["z", *Round.distance_formulas(self)]

    @property
    def middle(self) -> Array:
        """Half the radius above the plane."""
        middle: Array = 0.5 * self.radius * np.eye(self.dimension)[-1]
        return middle
