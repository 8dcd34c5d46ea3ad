"""What a container of fluid and bodies must answer, as plain NumPy geometry.

A container answers for itself all that others ask of it: its walls by name, how far a point lies from each,
what they look like, its periods. It knows nothing of meshes or physics. Lengths are in the user's unit;
points are arrays of shape (n, 2), in space (n, 3) with z upwards.

An axisymmetric container is a meridian half-plane: points are (r, z) with r >= 0, and the side r = 0 is the
axis, which is no wall.

One more shape in the plane is one more class, as in `box` and `round`: `walls`, `distances`, `normals`,
`size`, `volume` and `outline` are all that it must say where walls are straight; of round walls also
`spheres`, of others that are curved `plane`, `bends` and `waves`. A section of the case file makes it
(`fsi.case.domains`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from fsi.arrays import Array
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.curves import Sphere, WallCurve

if TYPE_CHECKING:
    from fsi.meshes.geometry.ellipsoid import PlacedEllipsoid
    from fsi.meshes.geometry.placed import Placed

HERE = 1e-9  # in sizes of a container: places that near are one
# From this ratio of radii on sizes in the fluid grow from the nearest edge: where they grew from that of the
# largest body, sparse meshes had velocities of discs thirty times smaller wrong by 1e-3.
UNLIKE = 2.0
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
        """Distance of each point (n, dimension) to each wall, shape (n, walls); positive inside.

        To the nearest point of the wall; or to its line or circle, if none of these crosses the inside.
        """

    @abstractmethod
    def normals(self, x: Array) -> Array:
        """Gradients of the distances: unit normals of the walls, into the fluid, (n, walls, dimension)."""

    def to_wall(self, wall: int, x: Array) -> tuple[Array, Array]:
        """The distances of points (n, dimension) to one wall, (n,), and their gradients, (n, dimension)."""
        return self.distances(x)[:, wall], self.normals(x)[:, wall]

    @abstractmethod
    def size(self) -> float:
        """A length that no distance inside exceeds."""

    @property
    @abstractmethod
    def volume(self) -> float:
        """Of fluid and bodies together: an area in the plane and in the meridional plane."""

    @property
    def volume_in_space(self) -> float:
        """The same, but with an axis of what revolves about it; what may have an axis says so."""
        return self.volume

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
    def edges(self) -> Array:
        """Lines by which a picture in space shows walls that are not plane, (n, 2, 3)."""
        return np.empty((0, 2, 3))

    @property
    def spheres(self) -> tuple[Sphere | None, ...]:
        """The circle or sphere that each wall follows, on either side of it; None for a plane wall."""
        return (None,) * len(self.walls)

    @property
    def plane(self) -> tuple[bool, ...]:
        """Whether each wall is plane, (walls,)."""
        return tuple(sphere is None for sphere in self.spheres)

    @property
    def concavities(self) -> tuple[int, ...]:
        """1 of round walls with the fluid within them, -1 of those with it outside, 0 of others, (walls,)."""
        arcs = self.outline() if self.dimension == 2 and any(self.spheres) else ()
        at = {curve.wall: curve.at(np.mean(curve.interval)[None])[0] for curve in arcs}
        found = [0] * len(self.walls)
        for k, sphere in enumerate(self.spheres):
            if sphere is not None:
                x = at.get(k, sphere.project(sphere.centre + np.eye(self.dimension)[0]))
                found[k] = 1 if self.normals(x[None])[0, k] @ sphere.from_centre(x) < 0.0 else -1
        return tuple(found)

    def reduced_radii(self, radii: Array) -> Array:
        """a_r of bodies (N,), (N, walls): a beside a plane, within a circle a R/(R - a), on it a R/(R+a)."""
        reduced = np.repeat(radii[:, None], len(self.walls), axis=1)
        for k, (sphere, side) in enumerate(zip(self.spheres, self.concavities, strict=True)):
            if sphere is not None:
                reduced[:, k] = radii * sphere.radius / (sphere.radius - side * radii)
        return reduced

    @property
    def waves(self) -> tuple[float, ...]:
        """How far it is on each wall from crest to crest, infinite on plane and round ones."""
        return (np.inf,) * len(self.walls)

    def bends(self, x: Array) -> Array:
        """The radius that sizes of elements follow on each wall where it is nearest to points x, (n, walls).

        Infinite on plane walls, and on round ones, which bodies are smaller than.
        """
        return np.full((len(x), len(self.walls)), np.inf)

    @property
    def far_walls(self) -> tuple[str, ...]:
        """Those that stand for infinity: no gap to them is ever narrow."""
        return ()

    def wall_fluxes(self) -> Array:
        """Integrals over each wall of n_i and, after them, of n_i x_j, (walls, d, 1 + d).

        n is the unit normal out of the fluid; with an axis they are integrals over surfaces of revolution.
        The flux of u_0 + G x is the sum of their products with u_0 and G. Fluid is incompressible: what only
        a flow with a source would feel, the integral of n.x, may be left out, as here in the plane.
        """
        fluxes = np.zeros((len(self.walls), 2, 3))
        for curve in self.outline():
            (x0, y0), (x1, y1) = curve.ends
            xy, xx, yy = 0.5 * (x1 * y1 - x0 * y0), 0.5 * (x1**2 - x0**2), 0.5 * (y1**2 - y0**2)
            fluxes[curve.wall] += [[y1 - y0, xy, yy], [x0 - x1, -xx, -xy]]
        return fluxes

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

    def at(self, t: float, strain: float = 0.0) -> Container:  # noqa: ARG002
        """The container at time t; only a cell changes, by its mean flow and by what a stress strained it."""
        return self

    def sheared(self, rate: float) -> Container:  # noqa: ARG002
        """The container as it is, if a stress shears it at that rate from now on; only a cell is."""
        return self

    def carried(self, e: Array, duration: float, strain: float = 0.0) -> Array:  # noqa: ARG002
        """What vectors e (n, d) between images become after some time, and a strain by a stress."""
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


@dataclass(frozen=True, slots=True, eq=False)
class FluidDomain:
    """Omega_F, a container without the bodies in it: what is meshed.

    Attributes:
        container: what encloses the fluid.
        centres: q_i, of a periodic container any images, (N, d).
        radii: a_i, (N,).
        corners: where a planar mesh is graded towards corners of the container, (n, 2).
        edges: the pairs of walls towards whose common edge a mesh in space is graded.
        placed: the bodies of a planar domain by their outlines; empty where all are discs.
        ellipsoids: those of a domain in space; empty where all are spheres.
    """

    container: Container
    centres: Array
    radii: Array
    corners: Array = field(default_factory=lambda: np.empty((0, 2)))
    edges: tuple[tuple[int, int], ...] = ()
    placed: tuple[Placed, ...] = ()
    ellipsoids: tuple[PlacedEllipsoid, ...] = ()

    @property
    def bent(self) -> bool:
        """Whether some outlines bend more here than there, or radii are unlike, so that sizes differ."""
        unlike = self.radii.max(initial=0.0) >= UNLIKE * self.radii.min(initial=np.inf)
        return bool(unlike) or not all(body.is_round for body in self.placed)
