"""Exact results that a case may be compared with, by name: `exact = "sphere_wall_normal"` in an expected row.

Each takes its gaps, radii, velocities and loads from the case at time 0, and gives the value of the row's
quantity: with forces that the FLUID exerts on the body. Sources stand at the functions of `fsi.lubrication`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fsi.lubrication import exact, spheres
from fsi.lubrication import sphere_beside_plane as beside
from fsi.lubrication import sphere_settling as sphere

if TYPE_CHECKING:
    from fsi.case.case import Case

TIME_AT_GAP = "time at gap "

type Reference = Callable[[Case, str], float]


def component(case: Case, quantity: str) -> tuple[str, int]:
    """The body and the mode of a quantity like `disc.force.y`, `ball.force.z` or `disc.torque`."""
    body, kind, *axis = quantity.split(".")
    if case.dimension == 2:
        return body, {"x": 0, "r": 0, "y": 1, "z": 1}[axis[0]] if axis else 2
    turning = 3 if kind in ("angular_velocity", "torque") else 0
    return body, turning + "xyz".index(axis[0])


def _beside_plane(case: Case) -> tuple[float, float, float]:
    """Gap, radius and viscosity of the first body beside the plane y = 0 (in space z = 0)."""
    body = case.bodies[0]
    return body.position[-1] - body.radius, body.radius, case.fluid.viscosity


def sphere_wall_normal(case: Case, quantity: str) -> float:
    """A sphere moving along the normal of a plane (Brenner 1961)."""
    _, mode = component(case, quantity)
    return -float(spheres.normal_resistance(*_beside_plane(case))) * float(case.motion(0.0).U[0, mode])


def sphere_beside_plane(case: Case, quantity: str) -> float:
    """A sphere in space moving and turning beside the plane z = 0, not about its normal.

    The functions of `fsi.lubrication.sphere_beside_plane` have x along the plane and y up: a rotation about
    our y turns against theirs, one about our x, with motion along y, turns with it.
    """
    place = _beside_plane(case)
    N = float(spheres.normal_resistance(*place))
    A = float(beside.parallel_resistance(*place))
    B = float(beside.coupling_resistance(*place))
    C = float(beside.rotation_resistance(*place))
    V_x, V_y, V_z, omega_x, omega_y, _ = case.motion(0.0).U[0]
    forces = (A * V_x - B * omega_y, A * V_y + B * omega_x, N * V_z)
    torques = (B * V_y + C * omega_x, C * omega_y - B * V_x)
    return -float((*forces, *torques)[component(case, quantity)[1]])


def two_spheres(case: Case, quantity: str) -> float:
    """Two spheres moving along their line of centres (Stimson and Jeffery 1926, Maude 1961)."""
    first, second = case.bodies
    gap = abs(second.position[1] - first.position[1]) - first.radius - second.radius
    U = case.motion(0.0).U[:, 1]
    forces = spheres.line_forces(gap, first.radius, second.radius, case.fluid.viscosity, U[0], U[1])
    body, _ = component(case, quantity)
    return -float(forces[case.names.index(body)])


def concentric_sphere(case: Case, quantity: str) -> float:
    """A sphere at the centre of a spherical container (Cunningham 1910)."""
    _, mode = component(case, quantity)
    body, outer = case.bodies[0], 0.5 * case.container().size()
    R = spheres.concentric_resistance(outer - body.radius, body.radius, case.fluid.viscosity)
    return -float(R) * float(case.motion(0.0).U[0, mode])


def disc_beside_plane(case: Case, quantity: str) -> float:
    """A disc moving along, towards or turning beside a plane (Jeffrey and Onishi 1981)."""
    laws = (exact.parallel_resistance, exact.normal_resistance, exact.rotation_resistance)
    _, mode = component(case, quantity)
    return -float(laws[mode](*_beside_plane(case))) * float(case.motion(0.0).U[0, mode])


def disc_in_shear(case: Case, quantity: str) -> float:
    """A free disc in the shear flow u = y e_x beside a plane (Jeffrey and Onishi 1981)."""
    gap, radius, _ = _beside_plane(case)
    velocity, omega = exact.free_in_shear(gap, radius, case.wall_velocity(0.0)["far"].shear)
    _, mode = component(case, quantity)
    return float((velocity, 0.0, omega)[mode])


def two_discs(case: Case, quantity: str) -> float:
    """Two equal discs approaching along their line of centres, which is an axis of coordinates."""
    body, mode = component(case, quantity)
    i = case.names.index(body)
    first, second = case.bodies
    gap = abs(second.position[mode] - first.position[mode]) - first.radius - second.radius
    U = case.motion(0.0).U[:, mode]
    return -float(exact.pair_resistance(gap, first.radius, case.fluid.viscosity)) * float(U[i] - U[1 - i])


def sphere_settling(case: Case, quantity: str) -> float:
    """The time in which a sphere settles to a gap."""
    start, radius, viscosity = _beside_plane(case)
    force = float(case.motion_at(case.configuration(), 0.0).F[0, 1])
    return float(sphere.settling_time(gap_of(quantity), start, radius, viscosity, force))


def disc_settling(case: Case, quantity: str) -> float:
    """The time in which a disc settles to a gap."""
    start, radius, viscosity = _beside_plane(case)
    force = float(case.motion_at(case.configuration(), 0.0).F[0, 1])
    return float(exact.settling_time(gap_of(quantity), start, radius, viscosity, force))


def gap_of(quantity: str) -> float:
    """The gap in `time at gap 0.1`."""
    return float(quantity.removeprefix(TIME_AT_GAP))


# The container of these is real, and does not stand for an infinite one.
ENCLOSED = ("concentric_sphere",)


@dataclass(frozen=True, slots=True)
class Fitting:
    """The cases that an exact result is of; quantities: "force" (and torque), "velocity" or "time"."""

    geometry: str
    shape: str
    bodies: int
    quantities: str


_EXACT: tuple[tuple[Reference, Fitting], ...] = (
    (sphere_wall_normal, Fitting("axisymmetric", "half-plane", 1, "force")),
    (sphere_beside_plane, Fitting("spatial", "half-plane", 1, "force")),
    (two_spheres, Fitting("axisymmetric", "round", 2, "force")),
    (concentric_sphere, Fitting("axisymmetric", "round", 1, "force")),
    (disc_beside_plane, Fitting("planar", "half-plane", 1, "force")),
    (disc_in_shear, Fitting("planar", "half-plane", 1, "velocity")),
    (two_discs, Fitting("planar", "round", 2, "force")),
    (sphere_settling, Fitting("axisymmetric", "half-plane", 1, "time")),
    (disc_settling, Fitting("planar", "half-plane", 1, "time")),
)
REFERENCES = {law.__name__: law for law, _ in _EXACT}
FITTING = {law.__name__: fitting for law, fitting in _EXACT}
