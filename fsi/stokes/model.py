"""The resolved model of a case: configuration and time in, velocities of the bodies out."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies import Array, Configuration, Inertia, Motion
from fsi.case import Case
from fsi.domain import WallVelocity
from fsi.stepping import Instant
from fsi.stokes.error import error_columns
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import Boundary, Clock, Field, solve
from meshes.build import FluidMesh, build
from meshes.move import Mover
from meshes.read import read_mesh
from meshes.sizing import Resolution


class StokesModel:
    """Meshes the fluid around the bodies and solves, for any configuration; collective over all ranks."""

    def __init__(self, case: Case) -> None:
        """A model of the case; nothing is meshed yet."""
        self.case = case
        self.container = case.container()
        given = case.discretisation
        self.resolution = Resolution(given.cells_per_gap, given.cells_per_circle, given.growth)
        self._moving = case.time is not None and case.time.remesh == "when-needed"
        self._mover: Mover | None = None

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> StokesSolution:
        """The flow at configuration q and time t.

        Raises:
            MeshError: no valid mesh can be made.
            SolveError: the solve fails or violates an identity.
        """
        clock = Clock()
        fluid = self._moved(q) if self._moving else self.mesh(q)
        clock.lap("mesh")
        degree = self.case.discretisation.degree
        return self._solve(fluid, q, t, self.case.motion_at(q, t), degree, inertia, clock)

    def enriched(self, q: Configuration, t: float, motion: Motion) -> StokesSolution:
        """The flow with elements and curved cells of one degree more, on a new mesh of the same triangles.

        Raises:
            MeshError, SolveError: as for the flow itself.
        """
        degree, clock = self.case.discretisation.degree + 1, Clock()
        return self._solve(self.mesh(q, degree), q, t, motion, degree, None, clock)

    def errors(self, q: Configuration, t: float, instant: Instant) -> dict[str, float]:
        """Columns of steps.csv with the estimated errors of an instant of this model; collective."""
        return error_columns(self, q, t, instant)

    def _solve(
        self, fluid: FluidMesh, q: Configuration, t: float, motion: Motion, degree: int,
        inertia: Inertia | None, clock: Clock,
    ) -> StokesSolution:  # fmt: skip
        return solve(
            fluid,
            self.container,
            q,
            motion,
            self._boundary(t),
            viscosity=self.case.fluid.viscosity,
            degree=degree,
            formulation=self.case.discretisation.formulation,
            solver=self.case.discretisation.solver,
            inertia=inertia,
            clock=clock,
        )

    def mesh(self, q: Configuration, order: int | None = None) -> FluidMesh:
        """A new mesh around the bodies at q, or the user's own; of the order of the case if not given."""
        order = order or self.case.discretisation.degree
        if self.case.domain.mesh is not None:
            path = Path(self.case.domain.mesh)
            return read_mesh(path, self.case.names, self.container, q.centres, q.radii, order)
        return build(self.container, q.centres, q.radii, self.resolution, order)

    def state(self) -> dict[str, NDArray[Any]]:
        """The centres around which the mesh in use was made: moved meshes start from it."""
        return {} if self._mover is None else {"meshed_centres": self._mover.centres}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Mesh again where the mesh in use was made."""
        if self._moving and "meshed_centres" in state:
            centres = state["meshed_centres"]
            radii = self.case.configuration().radii
            self._remesh(Configuration.unturned(centres, radii))

    def _moved(self, q: Configuration) -> FluidMesh:
        """The mesh in use, moved to q, or a new one where it would be too distorted."""
        if self._mover is not None:
            quality = self._mover.move(q.centres)
            if quality is not None:
                return self._mover.fluid.with_quality(quality)
        return self._remesh(q)

    def _remesh(self, q: Configuration) -> FluidMesh:
        if self._mover is not None:
            self._mover.close()
        self._mover = Mover(self.mesh(q), q.centres)
        return self._mover.fluid

    def _boundary(self, t: float) -> Boundary:
        """What holds at the walls at time t."""
        velocities = {wall: _field(given) for wall, given in self.case.wall_velocity(t).items()}
        return Boundary(velocities, self.case.wall_pressure())


def _field(given: WallVelocity) -> Field:
    """u(x) = velocity + shear h e_x with the last coordinate h, points (n, d) -> (n, d)."""

    def u(x: Array) -> Array:
        values = np.tile(given.velocity, (len(x), 1))
        values[:, 0] += given.shear * x[:, -1]
        return values

    return u
