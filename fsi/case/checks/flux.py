"""The walls of a case enclose an incompressible fluid: what flows in must flow out."""

from __future__ import annotations

import numpy as np

from fsi.bodies.configuration import Array
from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.errors import InputError
from fsi.meshes.geometry.containers import Box, Container, HalfPlane
from fsi.meshes.geometry.periodic import Channel


def check_flux(case: Case) -> None:
    """An incompressible fluid that is enclosed all round cannot take a net flux, at any time."""
    if case.wall_pressure() or not case.domain.walls:
        return
    normals = _wall_normals(case.container())
    for t in case.knots() or (0.0,):
        outward = {
            name: float(normals[name][:-1] @ given.velocity + normals[name][-1] * given.shear)
            for name, given in case.wall_velocity(t).items()
        }
        worst = max(outward, key=lambda name: abs(outward[name]))
        net = sum(outward.values())
        if abs(net) > 1e-12 * abs(outward[worst]):
            raise InputError(
                f"domain.walls.{worst} = {toml_text(case.domain.walls[worst])}: the net flux out of the "
                f'closed domain is {net:.6g} at t = {t:g}; balance the wall velocities or make a wall "open"'
            )


def _wall_normals(container: Container) -> dict[str, Array]:
    """For each wall the integrals of `n_x, n_y, y n_x` over it, n the unit normal out of the fluid.

    In space of `n_x, n_y, n_z, z n_x`.
    """
    if container.dimension == 3:
        return _wall_normals_in_space(container)
    if container.axisymmetric:
        return _wall_normals_around_axis(container)
    if isinstance(container, Box):
        (left, bottom), (right, top) = container.lower, container.upper
        across, along, moment = top - bottom, right - left, (top**2 - bottom**2) / 2.0
        rows = [(-across, 0.0, -moment), (across, 0.0, moment), (0.0, -along, 0.0), (0.0, along, 0.0)]
    elif isinstance(container, Channel):
        along = float(container.periods[0, 0])
        rows = [(0.0, -along, 0.0), (0.0, along, 0.0)]
    elif isinstance(container, HalfPlane):
        rows = [(0.0, -container.size(), 0.0), (0.0, container.size(), 0.0)]
    else:
        rows = [(0.0, 0.0, 0.0)]
    return {name: np.array(row) for name, row in zip(container.walls, rows, strict=True)}


def _wall_normals_in_space(container: Container) -> dict[str, Array]:
    if isinstance(container, Box):
        sides = np.subtract(container.upper, container.lower)
        areas = sides.prod() / sides
        rows = np.zeros((6, 4))
        for axis in range(3):
            rows[2 * axis, axis], rows[2 * axis + 1, axis] = -areas[axis], areas[axis]
        middle = 0.5 * (container.lower[2] + container.upper[2])
        rows[:2, 3] = middle * rows[:2, 0]
    elif isinstance(container, HalfPlane):
        across = np.pi * (0.5 * container.size()) ** 2
        rows = np.array([(0.0, 0.0, -across, 0.0), (0.0, 0.0, across, 0.0)])
    else:
        rows = np.zeros((1, 4))
    return dict(zip(container.walls, rows, strict=True))


def _wall_normals_around_axis(container: Container) -> dict[str, Array]:
    """The same with an axis: integrals of `n_r, n_z, 0` over surfaces of revolution."""
    across = np.pi * (0.5 * container.size()) ** 2
    if isinstance(container, Box):
        (_, bottom), (radius, top) = container.lower, container.upper
        across = np.pi * radius**2
        rows = [(2.0 * np.pi * radius * (top - bottom), 0.0, 0.0), (0.0, -across, 0.0), (0.0, across, 0.0)]
    elif isinstance(container, HalfPlane):
        rows = [(0.0, -across, 0.0), (0.0, across, 0.0)]
    else:
        rows = [(0.0, 0.0, 0.0)]
    return {name: np.array(row) for name, row in zip(container.walls, rows, strict=True)}
