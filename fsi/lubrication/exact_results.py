"""Exact results by name, with which a case may be compared: `exact = "two_discs"` in an expected row.

One more is one more function here, or anywhere that is imported, which `exact_result` enters with the cases
that it is of. It takes the bodies as they are at time 0 and gives the number that is asked for, with forces
that the FLUID exerts on the body. Sources stand at the functions that are called.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import nan
from typing import Literal

import numpy as np

from fsi.arrays import Array
from fsi.errors import refuse_taken
from fsi.lubrication import ellipsoids, exact, spheres
from fsi.lubrication import sphere_beside_plane as beside
from fsi.lubrication import spheres_in_shear as pair_in_shear
from fsi.lubrication import two_spheres as pair
from fsi.lubrication.concentric import Concentric
from fsi.meshes.geometry.ellipsoid import PlacedEllipsoid

# A ball that is so many times as far as spheres reach leaves out 1e-3 of their largest loads.
NEAR_CENTRE = 10.0


@dataclass(frozen=True, slots=True)
class ExactProblem:
    """Bodies at time 0, and which number is asked for.

    Attributes:
        viscosity: mu.
        centres: of the bodies, shape (N, d).
        radii: of the bodies, (N,).
        U: prescribed velocities, (N, M) for M modes of a body.
        F: external loads, (N, M).
        size: the diameter of the container.
        shear_rate: of the flow far away.
        body: index of the body whose force or velocity is asked for.
        mode: and which of its M modes.
        gap: at which gap the time is asked for.
        slip_length: of the first body.
        far_slip: of the container, where it is round.
        swimming: B_1 of the first body.
        half_axes: of the first body where it is an ellipsoid along the axes, NaN elsewhere, (3,).
        ellipsoids: the bodies where they are ellipsoids in space, turned in any way.
    """

    viscosity: float
    centres: Array
    radii: Array
    U: Array
    F: Array
    size: float
    shear_rate: float
    body: int = 0
    mode: int = 0
    gap: float = 0.0
    slip_length: float = 0.0
    far_slip: float = 0.0
    swimming: float = 0.0
    half_axes: tuple[float, float, float] = (nan, nan, nan)
    ellipsoids: tuple[PlacedEllipsoid, ...] = ()

    def concentric(self, *, spheres: bool) -> Concentric:
        """The first body at the centre of its container."""
        return Concentric(
            float(self.radii[0]), 0.5 * self.size, self.slip_length, self.far_slip, spheres=spheres
        )

    def beside_plane(self) -> tuple[float, float, float]:
        """Gap, radius and viscosity of the first body beside the plane y = 0 (in space z = 0)."""
        return float(self.centres[0, -1] - self.radii[0]), float(self.radii[0]), self.viscosity

    def pair_mobility(self) -> Array:
        """Of two spheres near the centre of a ball, (12, 12). Raises ValueError where they are not."""
        reach = float((np.linalg.norm(self.centres, axis=1) + self.radii).max())
        if 0.5 * self.size < NEAR_CENTRE * reach:
            raise ValueError(f"domain.radius = {0.5 * self.size:g}: need {NEAR_CENTRE * reach:g} at least")
        a, b = self.radii.tolist()
        alone = np.linalg.inv(pair.pair_matrix(self.centres, (a, b), self.viscosity))
        return pair.in_far_ball(alone, 0.5 * self.size, self.viscosity)

    def between(self, axis: int) -> float:
        """The gap between two bodies on an axis of coordinates."""
        return float(abs(self.centres[1, axis] - self.centres[0, axis]) - self.radii[0] - self.radii[1])


@dataclass(frozen=True, slots=True)
class Fitting:
    """The cases that an exact result is of.

    Attributes:
        geometry, shape: `geometry` and `domain.shape` of the case.
        bodies: how many there are.
        gives: "force" (and torque), "velocity" (and rotation) or "time".
        sheared: whether it needs a shear flow far away.
        enclosed: whether the container is real, and does not stand for an infinite one.
        place: the body at the centre, or two equal ones that meet along an axis of coordinates.
        shaped: whether bodies may have a `shape`.
    """

    geometry: str
    shape: str
    bodies: int
    gives: Literal["force", "velocity", "time"]
    sheared: bool = False
    enclosed: bool = False
    place: Literal["anywhere", "centre", "line"] = "anywhere"
    shaped: bool = False


@dataclass(frozen=True, slots=True)
class ExactResult:
    """One entry of the registry: the number, and the cases that it is of."""

    value: Callable[[ExactProblem], float]
    fitting: Fitting


EXACT: dict[str, ExactResult] = {}


def exact_result[F: Callable[[ExactProblem], float]](fitting: Fitting) -> Callable[[F], F]:
    """Enter a function, by its own name. Raises ValueError: another one has it."""

    def enter(value: F) -> F:
        if value.__name__ in EXACT:
            refuse_taken(value.__name__, EXACT[value.__name__].value, value)
        EXACT[value.__name__] = ExactResult(value, fitting)
        return value

    return enter


@exact_result(Fitting("axisymmetric", "half-plane", 1, "force"))
def sphere_wall_normal(problem: ExactProblem) -> float:
    """A sphere moving along the normal of a plane (Brenner 1961)."""
    return -float(spheres.normal_resistance(*problem.beside_plane())) * float(problem.U[0, problem.mode])


@exact_result(Fitting("spatial", "half-plane", 1, "force"))
def sphere_beside_plane(problem: ExactProblem) -> float:
    """A sphere in space moving and turning beside the plane z = 0, not about its normal.

    The functions of `fsi.lubrication.sphere_beside_plane` have x along the plane and y up: a rotation about
    our y turns against theirs, one about our x, with motion along y, turns with it.
    """
    place = problem.beside_plane()
    N = float(spheres.normal_resistance(*place))
    A = float(beside.parallel_resistance(*place))
    B = float(beside.coupling_resistance(*place))
    C = float(beside.rotation_resistance(*place))
    V_x, V_y, V_z, omega_x, omega_y, _ = problem.U[0]
    forces = (A * V_x - B * omega_y, A * V_y + B * omega_x, N * V_z)
    torques = (B * V_y + C * omega_x, C * omega_y - B * V_x)
    return -float((*forces, *torques)[problem.mode])


@exact_result(Fitting("axisymmetric", "round", 2, "force"))
def two_spheres(problem: ExactProblem) -> float:
    """Two spheres moving along their line of centres (Stimson and Jeffery 1926, Maude 1961)."""
    a, b, V, W = *problem.radii, *problem.U[:, 1]
    return -float(spheres.line_forces(problem.between(1), (a, b), problem.viscosity, (V, W))[problem.body])


@exact_result(Fitting("spatial", "round", 2, "force", enclosed=True))
def sphere_pair(problem: ExactProblem) -> float:
    """Two spheres that move and turn near the centre of a large ball (Jeffrey and Onishi 1984)."""
    loads = np.linalg.solve(problem.pair_mobility(), problem.U.ravel()).reshape(2, 6)
    return -float(loads[problem.body, problem.mode])


@exact_result(Fitting("spatial", "round", 2, "velocity", enclosed=True))
def free_sphere_pair(problem: ExactProblem) -> float:
    """Two spheres under forces and torques near the centre of a large ball."""
    return float((problem.pair_mobility() @ problem.F.ravel()).reshape(2, 6)[problem.body, problem.mode])


@exact_result(Fitting("axisymmetric", "round", 1, "force", enclosed=True, place="centre"))
def concentric_sphere(problem: ExactProblem) -> float:
    """A sphere at the centre of a spherical container (Cunningham 1910)."""
    a = problem.radii[0]
    R = spheres.concentric_resistance(0.5 * problem.size - a, a, problem.viscosity)
    return -float(R) * float(problem.U[0, problem.mode])


@exact_result(Fitting("axisymmetric", "round", 1, "force", enclosed=True, place="centre"))
def sliding_sphere(problem: ExactProblem) -> float:
    """A sphere at the centre of a spherical container, with slip on both."""
    V = float(problem.U[0, problem.mode])
    return -problem.concentric(spheres=True).force(V, problem.swimming, problem.viscosity)


@exact_result(Fitting("axisymmetric", "round", 1, "force", enclosed=True, place="centre", shaped=True))
def spheroid(problem: ExactProblem) -> float:
    """A spheroid along its axis, at the centre of a spherical container so large that it hardly counts.

    Oberbeck 1876, Brenner 1962: what is left out is (a / R)^3.
    """
    mu, axis = problem.viscosity, problem.mode + 1  # z of (r, z) is the third
    R = float(ellipsoids.translation_resistance(np.array(problem.half_axes), mu)[axis])
    return -ellipsoids.in_far_ball(R, 0.5 * problem.size, mu) * float(problem.U[0, problem.mode])


@exact_result(Fitting("spatial", "round", 1, "force", enclosed=True, place="centre", shaped=True))
def ellipsoid(problem: ExactProblem) -> float:
    """An ellipsoid with its axes along x, y and z, moving or turning at the centre of such a container."""
    axes, mu, speed = np.array(problem.half_axes), problem.viscosity, float(problem.U[0, problem.mode])
    if problem.mode < 3:
        R = float(ellipsoids.translation_resistance(axes, mu)[problem.mode])
        return -ellipsoids.in_far_ball(R, 0.5 * problem.size, mu) * speed
    return -float(ellipsoids.rotation_resistance(axes, mu)[problem.mode - 3]) * speed


@exact_result(
    Fitting("spatial", "round", 1, "velocity", sheared=True, enclosed=True, place="centre", shaped=True)
)
def ellipsoid_in_shear(problem: ExactProblem) -> float:
    """A free ellipsoid at the centre of such a container in the shear flow u = z e_x (Jeffery 1922)."""
    if not problem.ellipsoids:
        return nan
    body, shear = problem.ellipsoids[0], np.zeros((3, 3))
    shear[0, 2] = problem.shear_rate
    own = body.rotation
    omega = own @ ellipsoids.free_rotation(body.form.half_axes, own.T @ shear @ own)
    return float((0.0, 0.0, 0.0, *omega)[problem.mode])


@exact_result(Fitting("spatial", "round", 2, "velocity", sheared=True, enclosed=True))
def spheres_in_shear(problem: ExactProblem) -> float:
    """The velocity of one of two equal free spheres near the centre of such a container in u = z e_x.

    Batchelor and Green 1972; the point half-way between them moves with the flow. Turns are not given.
    """
    shear = np.zeros((3, 3))
    shear[0, 2] = problem.shear_rate
    (one, other), (a, b) = problem.centres, problem.radii.tolist()
    if a != b or problem.mode >= 3:
        return nan
    half = 0.5 * pair_in_shear.relative_velocity(other - one, a, shear)
    velocity = shear @ (0.5 * (one + other)) + (half if problem.body else -half)
    return float(velocity[problem.mode])


@exact_result(Fitting("planar", "round", 1, "force", enclosed=True, place="centre"))
def sliding_disc(problem: ExactProblem) -> float:
    """A disc moving or turning at the centre of a round container, with slip on both; none swims."""
    disc, speed = problem.concentric(spheres=False), float(problem.U[0, problem.mode])
    if problem.mode == 2:
        return -disc.torque(speed, problem.viscosity)
    return -disc.force(speed, 0.0, problem.viscosity)


@exact_result(Fitting("axisymmetric", "round", 1, "velocity", enclosed=True, place="centre"))
def swimming_sphere(problem: ExactProblem) -> float:
    """A free squirmer at the centre of a spherical container, with slip on both."""
    return problem.concentric(spheres=True).swimming(problem.swimming)


@exact_result(Fitting("planar", "round", 1, "velocity", enclosed=True, place="centre"))
def swimming_disc(problem: ExactProblem) -> float:
    """A free squirming disc at the centre of a round container; its axis is that of x."""
    return problem.concentric(spheres=False).swimming(problem.swimming) if problem.mode == 0 else 0.0


@exact_result(Fitting("planar", "half-plane", 1, "force"))
def disc_beside_plane(problem: ExactProblem) -> float:
    """A disc moving along, towards or turning beside a plane (Jeffrey and Onishi 1981)."""
    laws = (exact.parallel_resistance, exact.normal_resistance, exact.rotation_resistance)
    return -float(laws[problem.mode](*problem.beside_plane())) * float(problem.U[0, problem.mode])


@exact_result(Fitting("planar", "half-plane", 1, "velocity", sheared=True))
def disc_in_shear(problem: ExactProblem) -> float:
    """A free disc in the shear flow u = y e_x beside a plane (Jeffrey and Onishi 1981)."""
    gap, radius, _ = problem.beside_plane()
    velocity, omega = exact.free_in_shear(gap, radius, problem.shear_rate)
    return float((velocity, 0.0, omega)[problem.mode])


@exact_result(Fitting("planar", "round", 2, "force", place="line"))
def two_discs(problem: ExactProblem) -> float:
    """Two equal discs approaching along their line of centres, which is an axis of coordinates."""
    i, U = problem.body, problem.U[:, problem.mode]
    R = exact.pair_resistance(problem.between(problem.mode), problem.radii[0], problem.viscosity)
    return -float(R) * float(U[i] - U[1 - i])


@exact_result(Fitting("axisymmetric", "half-plane", 1, "time"))
def sphere_settling(problem: ExactProblem) -> float:
    """The time in which a sphere settles to a gap."""
    return float(spheres.settling_time(problem.gap, *problem.beside_plane(), problem.F[0, 1]))


@exact_result(Fitting("planar", "half-plane", 1, "time"))
def disc_settling(problem: ExactProblem) -> float:
    """The time in which a disc settles to a gap."""
    return float(exact.settling_time(problem.gap, *problem.beside_plane(), problem.F[0, 1]))
