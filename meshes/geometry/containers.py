"""The containers that hold fluid and bodies, as plain NumPy geometry.

A container answers for itself all that others ask of it: its walls by name, how far a point lies from each,
what they look like, its periods. It knows nothing of meshes or physics. Lengths are in the user's unit;
points are arrays of shape (n, 2), in space (n, 3) with z upwards.

An axisymmetric container is a meridian half-plane: points are (r, z) with r >= 0, and the side r = 0 is the
axis, which is no wall.

One more shape in the plane is one more class here: `walls`, `distances`, `normals`, `size`, `volume` and
`outline` are all that it must say. A section of the case file makes it (`fsi.case.domains`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations, product
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.curves import Sphere, WallCurve, arc, rescaled, segment

Array = NDArray[np.float64]

HERE = 1e-9  # in sizes of a container: places that near are one
_LARGEST_IN_BOX = 0.25  # largest element in space, over the size of a container with plane walls


class Container(ABC):
    """What encloses the fluid; a value, equal to others with the same numbers.

    Methods with a body here suit most shapes; a shape says what is different with it.
    """

    __slots__ = ()

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space: the number of coordinates of a point."""
        return 2

    @property
    def axisymmetric(self) -> bool:
        """True where points are (r, z)."""
        return False

    @property
    @abstractmethod
    def walls(self) -> tuple[str, ...]:
        """Names of the walls, in the order of every array over walls."""

    @abstractmethod
    def distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to each wall, shape (n, walls); positive inside."""

    @abstractmethod
    def normals(self, x: Array) -> Array:
        """Gradients of the distances: unit normals of the walls, into the fluid, (n, walls, dimension)."""

    @abstractmethod
    def size(self) -> float:
        """A length that no distance inside exceeds."""

    @property
    @abstractmethod
    def volume(self) -> float:
        """Of fluid and bodies together: an area in the plane and in the meridional plane."""

    def outline(self) -> tuple[WallCurve, ...]:
        """The walls in the plane, wall by wall; together with an axis they go once around the container."""
        raise MeshError("no domain of this shape is meshed in the plane")

    def meetings(self) -> dict[tuple[int, int], Array]:
        """The pairs of walls that meet, and where, (n, dimension): corners, in space ends of edges."""
        ends = [(curve.wall, end) for curve in self.outline() for end in curve.ends]
        near, found = HERE * self.size(), dict[tuple[int, int], list[Array]]()
        for (one, x), (other, y) in combinations(ends, 2):
            if one != other and np.hypot(*(x - y)) <= near:
                found.setdefault((min(one, other), max(one, other)), []).append(x)
        return {pair: np.array(corners) for pair, corners in found.items()}

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """For each wall the axis of its normal at its corners: that velocity component is its own there."""
        ends = {curve.wall: curve.ends for curve in self.outline()}
        return tuple(int(np.abs(self.normals(ends[k])[0, k]).argmax()) for k in range(len(self.walls)))

    @property
    def faces(self) -> Mapping[str, tuple[int, float]]:
        """Of a box, the axis across each wall and where the wall stands on it; empty elsewhere."""
        return {}

    @property
    def spheres(self) -> tuple[Sphere | None, ...]:
        """The circle or sphere that each wall follows, seen from inside; None for a plane wall."""
        return (None,) * len(self.walls)

    @property
    def far_walls(self) -> tuple[str, ...]:
        """Those that stand for infinity: no gap to them is ever narrow."""
        return ()

    def wall_fluxes(self) -> Array:
        """Integrals over each wall of n and h n_x, (walls, d + 1).

        n is the unit normal out of the fluid, h the last coordinate; with an axis they are integrals over
        surfaces of revolution. So they are the fluxes of unit velocities and of a unit shear flow.
        """
        rows = np.zeros((len(self.walls), 3))
        for curve in self.outline():
            (x0, y0), (x1, y1) = curve.ends
            rows[curve.wall] += y1 - y0, x0 - x1, 0.5 * (y1**2 - y0**2)
        return rows

    def axis(self) -> tuple[float, float]:
        """Lowest and highest z of an axisymmetric container on its axis."""
        on_axis = [float(z) for curve in self.outline() for r, z in curve.ends if r == 0.0]
        return min(on_axis), max(on_axis)

    @property
    def boundary_names(self) -> tuple[str, ...]:
        """Names of the walls, and last `axis` or `cut` where there is one, in the order of their tags.

        The tags follow the bodies'. The cut is where a periodic domain was opened for meshing.
        """
        if self.axisymmetric:
            return (*self.walls, "axis")
        return (*self.walls, "cut") if len(self.periods) else self.walls

    def boundary_distances(self, x: Array) -> Array:
        """Distance of each point (n, dimension) to each wall, and last to the axis if there is one."""
        to_walls = self.distances(x)
        return np.column_stack([to_walls, x[:, 0]]) if self.axisymmetric else to_walls

    @property
    def periods(self) -> Array:
        """Vectors that carry the domain onto itself, as rows, shape (k, d)."""
        return np.empty((0, self.dimension))

    @property
    def image_reach(self) -> float:
        """The gap up to which bodies and images are looked for, at all times; infinite without periods."""
        return np.inf

    @property
    def mean_gradient(self) -> Array:
        """E of the mean flow u = E x, rows of (dV_i / dx_j), shape (d, d): zero but in a cell."""
        return np.zeros((self.dimension, self.dimension))

    def mean_velocity(self, x: Array) -> Array:
        """The mean flow E x at points or between images, (n, d)."""
        velocity: Array = x @ self.mean_gradient.T
        return velocity

    def at(self, t: float) -> Container:  # noqa: ARG002
        """The container at time t; only a sheared cell changes."""
        return self

    def carried(self, e: Array, duration: float) -> Array:  # noqa: ARG002
        """What vectors e (n, d) between images become after some time."""
        return e

    @property
    def middle(self) -> Array:
        """The middle of the box around it, or of what a cell's vectors span from the origin, (d,)."""
        return np.zeros(self.dimension)

    def scaled(self, factor: float) -> Container:
        """The container with all lengths times the factor, to 15 digits where its numbers are known."""
        from fsi.meshes.geometry.stretched import Stretched  # which is one itself

        return self if factor == 1.0 else Stretched(self, factor)

    def seen_from(self, origin: Array) -> Container | None:  # noqa: ARG002
        """The container in coordinates with this origin, (d,); None where its shape stands at its own."""
        return None

    # What meshing in space asks besides.

    def solid(self, kernel: Any) -> int:  # noqa: ARG002
        """The inside as a solid of gmsh's kernel (`gmsh.model.occ`), without bodies: its number."""
        raise MeshError("no domain of this shape is meshed in space")

    def distance_formulas(self) -> list[str]:
        """The distance to each wall as a formula in x, y, z."""
        raise NotImplementedError

    def largest_element(self, cells_per_circle: int) -> float:
        """What no tetrahedron exceeds: on a round wall as on a body, elsewhere a part of the size."""
        radii = [sphere.radius for sphere in self.spheres if sphere is not None]
        if not radii:
            return _LARGEST_IN_BOX * self.size()
        return float(np.pi * (2.0 * max(radii)) / cells_per_circle)


def lengths(x: Array) -> Array:
    """Euclidean length of each vector, shape (n, dimension) -> (n,)."""
    length: Array = np.hypot.reduce(x, axis=1)
    return length


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
        return [side for s, low, high in sides for side in (f"({s}-({low!r}))", f"(({high!r})-{s})")]

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


@dataclass(frozen=True, slots=True, eq=False)
class FluidDomain:
    """Omega_F, a container without the bodies in it: what is meshed.

    Attributes:
        container: what encloses the fluid.
        centres: q_i, of a periodic container any images, (N, d).
        radii: a_i, (N,).
        corners: where a planar mesh is graded towards corners of the container, (n, 2).
        edges: the pairs of walls towards whose common edge a mesh in space is graded.
    """

    container: Container
    centres: Array
    radii: Array
    corners: Array = field(default_factory=lambda: np.empty((0, 2)))
    edges: tuple[tuple[int, int], ...] = ()


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
