"""The resolved model of a case: configuration and time in, velocities of the bodies out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration, Inertia, Motion
from fsi.case.case import Case
from fsi.case.walls import WallVelocity
from fsi.meshes.build import FluidMesh, build
from fsi.meshes.files.read import read_mesh
from fsi.meshes.geometry.containers import FluidDomain
from fsi.meshes.geometry.lattice import Lattice
from fsi.meshes.moving.move import Mover
from fsi.meshes.planar.sizing import Resolution
from fsi.observables.error_estimate import Results, StepErrors
from fsi.stokes.discretisation.boundary import Boundary, Field
from fsi.stokes.error import motion_of, other_degree_of, step_errors
from fsi.stokes.problem import SolverOptions, StokesProblem
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import Clock, solve
from fsi.stokes.solvers.workspace import Workspace


class StokesModel:
    """Meshes the fluid around the bodies and solves, for any configuration; collective over all ranks."""

    def __init__(self, case: Case) -> None:
        """A model of the case; nothing is meshed yet."""
        self.case = case
        numerics = case.discretisation
        self.resolution = Resolution(
            numerics.cells_per_gap, numerics.cells_per_circle, numerics.growth, numerics.interior
        )
        self.options = SolverOptions(numerics.degree, numerics.formulation, numerics.solver)
        self._moving = case.time is not None and case.time.remesh == "when-needed"
        self._mover: Mover | None = None
        self._meshed_time = 0.0
        self._workspace = Workspace()

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> StokesSolution:
        """The flow at configuration q and time t.

        Raises:
            MeshError: no valid mesh can be made.
            SolveError: the solve fails or violates an identity.
        """
        clock = Clock()
        fluid = self._moved(q, t) if self._moving else self.mesh(q, t)
        clock.lap("mesh")
        problem = self.problem(fluid, q, t, self.case.motion_at(q, t))
        workspace = self._workspace if self._moving else None
        return solve(replace(problem, inertia=inertia), self.options, clock, workspace)

    def of_degree(self, degree: int, q: Configuration, t: float, motion: Motion) -> StokesSolution:
        """The flow with elements and curved cells of another degree, on a new mesh of the same simplices.

        Raises MeshError, SolveError: as for the flow itself.
        """
        clock = Clock()
        problem = self.problem(self.mesh(q, t, degree), q, t, motion)
        return solve(problem, replace(self.options, degree=degree), clock)

    def errors(
        self, q: Configuration, t: float, instant: Results, motion: Motion | None = None
    ) -> StepErrors:
        """The estimated errors of an instant of this model at q and t; one solve more, collective.

        motion: what held and drove the bodies; None: that of the case at this instant.

        Raises MeshError, SolveError: as for the flow, with the other degree.
        """
        motion = motion or motion_of(self.case, q, t, instant)
        degree, _ = other_degree_of(self.options.degree, q.dimension)
        return step_errors(self.case, t, instant, self.of_degree(degree, q, t, motion))

    def problem(self, fluid: FluidMesh, q: Configuration, t: float, motion: Motion) -> StokesProblem:
        """What the case asks for on a mesh of the fluid around the bodies at q and t, without inertia."""
        case = self.case
        velocities = {wall: _field(velocity) for wall, velocity in case.wall_velocity(t).items()}
        boundary = Boundary(velocities, case.wall_pressure(), None, *case.domain.mean_drive())
        container, viscosity, moment = (
            case.container().at(t),
            case.fluid.viscosity,
            case.interaction_moment(q, t),
        )
        return StokesProblem(fluid, container, q, motion, boundary, viscosity, interaction=moment)

    def mesh(self, q: Configuration, t: float = 0.0, order: int | None = None) -> FluidMesh:
        """A new mesh around the bodies at q and t, or the user's own; of the case's order if not given."""
        order = order or self.case.discretisation.degree
        domain = FluidDomain(self.case.container().at(t), q.centres, q.radii)
        if self.case.domain.mesh is not None:
            path = Path(self.case.domain.mesh)
            return read_mesh(path, self.case.names, domain, order)
        return build(domain, self.resolution, order)

    def state(self) -> dict[str, NDArray[Any]]:
        """The centres around which the mesh in use was made, and when: moved meshes start from it."""
        if self._mover is None:
            return {}
        return {"meshed_centres": self._mover.centres, "meshed_time": np.array(self._meshed_time)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Mesh again where the mesh in use was made."""
        if self._moving and "meshed_centres" in state:
            centres = state["meshed_centres"]
            radii = self.case.configuration().radii
            self._remesh(Configuration.unturned(centres, radii), float(state["meshed_time"]))

    def _moved(self, q: Configuration, t: float) -> FluidMesh:
        """The mesh in use, moved to q and t, or a new one where it would be too distorted."""
        if self._mover is not None:
            container, duration = self.case.container(), t - self._meshed_time
            quality = self._mover.move(q.centres, lambda e: container.carried(e, duration))
            if quality is not None:
                return self._mover.fluid.moved(quality, Lattice(container.at(t).periods))
        return self._remesh(q, t)

    def _remesh(self, q: Configuration, t: float) -> FluidMesh:
        self._workspace.close()
        if self._mover is not None:
            self._mover.close()
        self._mover, self._meshed_time = Mover(self.mesh(q, t), q.centres), t
        return self._mover.fluid


def _field(wall: WallVelocity) -> Field:
    """u(x) = velocity + shear h e_x with the last coordinate h, points (n, d) -> (n, d)."""

    def u(x: Array) -> Array:
        values = np.tile(wall.velocity, (len(x), 1))
        values[:, 0] += wall.shear * x[:, -1]
        return values

    return u
