"""Small resolved problems that several tests share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Motion
from fsi.meshes.build import FluidMesh, build
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.round import HalfPlane
from fsi.meshes.resolution import Resolution
from fsi.stokes.problem import Boundary, Formulation, SolverOptions, StokesProblem
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import solve

BOX = Box((-8.0, 0.0), (8.0, 16.0))
SMALL_BOX = Box((-3.0, -2.0), (3.0, 2.0))


def discs(centres: Sequence[tuple[float, float]], radii: Sequence[float]) -> Configuration:
    return Configuration(np.array(centres, dtype=float), np.zeros(len(radii)), np.array(radii, dtype=float))


def disc_over_plane(gap: float) -> Configuration:
    return discs([(0.0, 1.0 + gap)], [1.0])


def held(*velocities: Sequence[float] | Array) -> Motion:
    """All modes prescribed."""
    U = np.array(velocities, dtype=float)
    return Motion(np.ones(U.shape, dtype=bool), U, np.zeros_like(U))


def free(*loads: Sequence[float] | Array) -> Motion:
    """All modes free under given loads."""
    F = np.array(loads, dtype=float)
    return Motion(np.zeros(F.shape, dtype=bool), np.zeros_like(F), F)


def at_rest(x: Array) -> Array:
    return np.zeros_like(x)


def shear(x: Array) -> Array:
    """u = y e_x."""
    return np.column_stack([x[:, 1], np.zeros(len(x))])


def resting(container: Container) -> Boundary:
    return Boundary(dict.fromkeys(container.walls, at_rest), {})


def mesh(
    container: Container, q: Configuration, resolution: Resolution | None = None, order: int = 3
) -> FluidMesh:
    return build(FluidDomain(container, q.centres, q.radii), resolution or Resolution(), order)


def solved(
    container: Container,
    q: Configuration,
    motion: Motion,
    boundary: Boundary | None = None,
    resolution: Resolution | None = None,
    degree: int = 3,
    formulation: Formulation = "eliminated",
) -> StokesSolution:
    """Mesh and solve at mu = 1."""
    fluid = mesh(container, q, resolution, degree)
    problem = StokesProblem(fluid, container, q, motion, boundary or resting(container))
    return solve(problem, SolverOptions(degree, formulation))


HALF_PLANE = HalfPlane(5000.0)
