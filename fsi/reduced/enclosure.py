"""What surrounds the bodies of the reduced model: walls, periods, the flow far from every body, drag."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.case.background_flow import background
from fsi.case.case import Case
from fsi.case.wall_velocity import WallVelocities
from fsi.meshes.geometry.container import Container, lengths

# The rotation of the flow u = E x is the antisymmetric part of E: d = 2 has the mode omega, d = 3 three of
# them.
_SPINS = {2: ((1, 0),), 3: ((2, 1), (0, 2), (1, 0))}


@dataclass(frozen=True, slots=True)
class Enclosure:
    """What encloses the bodies at one instant, in d dimensions, and the flow in it without them.

    Bodies are dragged relative to the background flow `u_inf = u_0 + E x`, which carries a lattice along.

    Attributes:
        container: its walls and periods.
        solid: which walls are, the others being open, (walls,).
        wall_velocities: of each wall.
        mean: u_0, (d,).
        gradient: E, rows of (du_i / dx_j), (d, d).
    """

    container: Container
    solid: NDArray[np.bool_]
    wall_velocities: WallVelocities
    mean: Array
    gradient: Array

    @property
    def strain_rate(self) -> Array:
        """The symmetric part of the gradient, (d, d)."""
        return np.asarray(0.5 * (self.gradient + self.gradient.T))

    def background(self, x: Array) -> Array:
        """`u_inf` and its rate of rotation in all modes at points (n, d), shape (n, modes)."""
        E = self.gradient
        spins = [0.5 * (E[i, j] - E[j, i]) for i, j in _SPINS[len(E)]]
        return np.column_stack([self.mean + x @ E.T, np.broadcast_to(spins, (len(x), len(spins)))])


@dataclass(frozen=True, slots=True)
class WallGaps:
    """All pairs of a body and a wall.

    Attributes:
        gap: D, (N, W).
        normal: from the wall into the fluid, (N, W, d).
        radius: the reduced radius a_r, (N, W).
        curvature: of the gap along the wall, 0 for a plane one, (N, W).
        lubricates: whether the wall can be near, (W,).
    """

    gap: Array
    normal: Array
    radius: Array
    curvature: Array
    lubricates: NDArray[np.bool_]


def make_enclosure(case: Case, t: float) -> Enclosure:
    """Walls, periods and background flow of a case at time t. Raises InputError: that flow is not known."""
    return with_flow(case, t, *background(case.container().at(t), case.wall_velocity(t)))


def with_flow(case: Case, t: float, mean: Array, gradient: Array) -> Enclosure:
    """Walls and periods of a case at time t, with a flow `mean + gradient x` without bodies."""
    container, walls = case.container().at(t), case.wall_velocity(t)
    velocities = WallVelocities.given(container.walls, walls, container.dimension)
    solid = np.array([name in walls for name in container.walls], dtype=bool)
    return Enclosure(container, solid, velocities, mean, gradient)


def drag(case: Case) -> Array:
    """The drag coefficients zeta of lone bodies, (N, modes).

    Translation: `reduced.drag` times mu a for spheres, mu for discs; rotation: 8 pi mu a^3 of a sphere, 4 pi
    mu a^2 of a disc per unit length, the exact ones in unbounded fluid.
    """
    mu, q = case.fluid.viscosity, case.configuration()
    modes, d = case.motion(0.0).U.shape[1], q.centres.shape[1]
    scale = mu * q.radii if case.spheres else np.full(len(q), mu)
    turning = 8.0 * np.pi * mu * q.radii**3 if case.spheres else 4.0 * np.pi * mu * q.radii**2
    return np.column_stack([case.drag * scale] * d + [turning] * (modes - d))


def wall_gaps(container: Container, centres: Array, radii: Array) -> WallGaps:
    """Gaps between bodies (N, d) and walls.

    A wall that stands for infinity lubricates nothing.
    """
    gap = container.distances(centres) - radii[:, None]
    curvature = np.zeros_like(gap)
    lubricates = np.array([name not in container.far_walls for name in container.walls], dtype=bool)
    for k, (sphere, side) in enumerate(zip(container.spheres, container.concavities, strict=True)):
        if sphere is not None and lubricates[k]:
            distance = lengths(centres - sphere.centre)
            curvature[:, k] = -side / np.where(distance > 0.0, distance, 1.0)
    return WallGaps(gap, container.normals(centres), container.reduced_radii(radii), curvature, lubricates)


def overlap(reduced: Array, radius: Array) -> Array:
    """`a b/(a + b)^2` of a_r = a b/(a + b) and a, which with it decides a law; within a round wall b = -R."""
    part = reduced / radius
    return part * (1.0 - part)
