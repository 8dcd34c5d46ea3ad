"""The resolved model of a case: configuration and time in, velocities of the bodies out, with error bars.

The error bar on every force and velocity comes from the same problem with elements of another degree. Forces
from the reactions, and the velocities of free bodies, converge like h^(2k) with elements of degree k in
velocity and geometry (they are energies, so their error is the square of the flow's). On the same mesh the
values of degree k + 1 are therefore 10 to 1000 times closer to the exact ones, and the difference of the two
is the error of the first. Measured against exact solutions for a disc and a sphere beside a plane, gaps from
1e-5 to 10 radii and k = 2, 3, 4, it is 0.97 to 1.01 times the true error; 1.10 times once, at an error of
1e-10, where rounding begins. On meshes too coarse far away, where one degree more gains only a factor 10, it
is 0.9 times. The factor SAFETY makes it a bound.

In space one degree more costs some ten times as much as the solution itself. There the same problem is solved
with one degree less, for a tenth of it: its values are the less accurate ones, and the difference is their
error. Measured beside a plane for k = 3, gaps from 0.01 to 1 radii, it is 14 to 50 times that of degree k on
the default meshes and finer ones, and 9 times on a mesh half as fine. The factor FEWER makes it a bound.
Degree 2, which has none below, takes one more.

Where the data of walls jump at a corner (see `corners`), two degrees on one mesh miss the same there, and
their difference does not tell it. Planar meshes are graded towards such corners, so that the order comes
back, and the other problem is then solved on another mesh: one with `growth` over FINER, which is graded more
finely and deeper (see `fsi.meshes.planar.grading`). So is the one beside a user's own mesh, which is not
graded. The difference is 0.97 to 1.05 times the error of the first again.

In space meshes are not graded towards edges. Where walls' data do not fit there the error is that of the
cells beside the edge, and goes with the distance of nodes h / k like (h / k)^p, p = 2.74 where velocities
jump and 1.19 between an open wall and a solid one (see `corners`), so that of two degrees k and m

    error = difference / |1 - (k / m)^p|,

and the bar is SAFETY times that where it is more. With FEWER bars of random cases with sliding lids were up
to 2.2 times too small for k = 3.

It sees the mesh and the elements; it does not see how far a container of finite radius is from an infinite
one (`fsi.observables.truncation` does), nor how a user's own curved mesh differs from its circles.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration, Inertia, Motion
from fsi.case.case import Case
from fsi.case.walls import WallVelocity
from fsi.integration.errors import StepErrors
from fsi.integration.state import Results
from fsi.meshes.build import FluidMesh, build
from fsi.meshes.errors import MeshError
from fsi.meshes.files.read import read_mesh
from fsi.meshes.geometry.containers import Container, FluidDomain
from fsi.meshes.moving.move import Mover
from fsi.meshes.planar.sizing import Resolution
from fsi.observables.bars import DrivenBodies, motion_of, step_errors
from fsi.stokes.corners import jumps, singular
from fsi.stokes.problem import Boundary, Field, SolverOptions, StokesProblem
from fsi.stokes.refusal import explained
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import Clock, solve
from fsi.stokes.solvers.workspace import Workspace
from fsi.stokes.units import Units

SAFETY = 1.5
FEWER = 0.15
FINER = 1.5
# How the error of a force goes with h beside edges of a box in space.
JUMP_ORDER, OPEN_ORDER = 2.74, 1.19
LOWEST = 2


def other_degree_of(degree: int, dimension: int) -> tuple[int, float]:
    """The degree with which a problem is solved again, and what makes the difference a bound of the error."""
    return (degree - 1, FEWER) if dimension == 3 and degree > LOWEST else (degree + 1, SAFETY)


def bar_factor(case: Case) -> float:
    """What makes the difference from the flow with `other_degree_of` a bound of the error."""
    degree = case.discretisation.degree
    other, factor = other_degree_of(degree, case.dimension)
    if case.dimension == 2:
        return factor
    container, powers = case.container(), set[float]()
    for t in wall_kinks(case):
        boundary = boundary_of(case, t)
        edges, jumping = singular(container, boundary), jumps(container, boundary)
        powers |= {JUMP_ORDER if edge in jumping else OPEN_ORDER for edge in edges}
    return float(max([factor, *(SAFETY / abs(1.0 - (degree / other) ** p) for p in powers)]))


class StokesModel:
    """Meshes the fluid around the bodies and solves, for any configuration; collective over all ranks."""

    def __init__(self, case: Case) -> None:
        """A model of the case; nothing is meshed yet."""
        self.case = case
        sizes = case.discretisation
        along = (sizes.cells_per_gap, sizes.cells_per_circle, sizes.growth, sizes.interior)
        self.resolution = Resolution(*along)
        self.options = SolverOptions(sizes.degree, sizes.formulation, sizes.solver)
        self._moving = case.time is not None and case.time.remesh == "when-needed"
        self._mover: Mover | None = None
        self._meshed_centres, self._meshed_time = case.configuration().centres, 0.0
        self._workspace = Workspace()
        self.units = Units.of(case)
        self._corners = self.units.scaled_places(singular_corners(case))

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> StokesSolution:
        """The flow at q and t. Raises MeshError; SolveError: the solve fails or violates an identity."""
        clock = Clock()
        fluid = self._moved(q, t) if self._moving else self.scaled_mesh(q, t)
        clock.lap("mesh")
        problem = replace(self.problem(fluid, q, t, self.case.motion_at(q, t)), inertia=inertia)
        workspace = self._workspace if self._moving else None
        with explained(problem, self.case.names):
            found = solve(self.units.scaled(problem), self.options, clock, workspace)
        return self.units.user_solution(found, problem)

    def reference(self, q: Configuration, t: float, motion: Motion) -> StokesSolution:
        """The flow from which that of the case differs by its error; see the module."""
        clock, (degree, _) = Clock(), other_degree_of(self.options.degree, q.dimension)
        return self._solved(self.problem(self.reference_mesh(q, t), q, t, motion), degree, clock)

    def of_degree(self, degree: int, q: Configuration, t: float, motion: Motion) -> StokesSolution:
        """The flow with elements and curved cells of another degree, on a new mesh of the same simplices."""
        clock = Clock()
        return self._solved(self.problem(self.scaled_mesh(q, t, degree), q, t, motion), degree, clock)

    def _solved(self, problem: StokesProblem, degree: int, clock: Clock) -> StokesSolution:
        with explained(problem, self.case.names):
            found = solve(self.units.scaled(problem), replace(self.options, degree=degree), clock)
        return self.units.user_solution(found, problem)

    def errors(
        self, q: Configuration, t: float, instant: Results, motion: Motion | None = None
    ) -> StepErrors:
        """The estimated errors of an instant of this model at q and t; one solve more, collective.

        motion: what held and drove the bodies; None: that of the case at this instant. Raises MeshError,
        SolveError: as for the flow, with the other degree.
        """
        motion = motion or motion_of(self.case, q, t, instant)
        bodies = DrivenBodies(self.case, q, t, motion)
        return step_errors(bodies, instant, self.reference(q, t, motion), bar_factor(self.case))

    def problem(self, fluid: FluidMesh, q: Configuration, t: float, motion: Motion) -> StokesProblem:
        """What the case asks for at q and t, without inertia, on a mesh in the units of the model."""
        case, boundary = self.case, boundary_of(self.case, t)
        container, mu, moment = case.container().at(t), case.fluid.viscosity, case.interaction_moment(q, t)
        return StokesProblem(fluid, container, q, motion, boundary, mu, interaction=moment)

    def mesh(self, q: Configuration, t: float = 0.0) -> FluidMesh:
        """A new mesh around the bodies at q and t, or the user's own."""
        return self.units.user_mesh(self.scaled_mesh(q, t), self.case.container().at(t))

    def scaled_mesh(self, q: Configuration, t: float = 0.0, order: int | None = None) -> FluidMesh:
        """The same mesh in the units of the model; of the case's order if not given."""
        case, order = self.case, order or self.case.discretisation.degree
        if case.domain.mesh is None:
            return self._built(q, t, self.resolution, order)
        domain = FluidDomain(case.container().at(t), q.centres, q.radii)
        fluid = read_mesh(Path(case.domain.mesh), case.names, domain, order)
        return fluid.scaled(1.0 / self.units.length, self._container().at(t))

    def reference_mesh(self, q: Configuration, t: float = 0.0) -> FluidMesh:
        """The mesh for `reference`: cells of its degree, and others where the flow has singular corners."""
        degree, _ = other_degree_of(self.options.degree, q.dimension)
        if len(self._corners) == 0:
            return self.scaled_mesh(q, t, degree)
        return self._built(q, t, replace(self.resolution, growth=self.resolution.growth / FINER), degree)

    def _built(self, q: Configuration, t: float, resolution: Resolution, order: int) -> FluidMesh:
        """A new mesh in the units of the model, whatever the user has."""
        centres, radii = self.units.scaled_places(q.centres), self.units.scaled_lengths(q.radii)
        try:
            domain = FluidDomain(self._container().at(t), centres, radii, self._corners)
            return build(domain, resolution, order)
        except MeshError as error:
            raise error.in_units(self.units.length, self.units.origin) from error

    def _container(self) -> Container:
        """At time 0, in the units of the model."""
        return self.units.scaled_container(self.case.container())

    def state(self) -> dict[str, NDArray[Any]]:
        """The centres around which the mesh in use was made, and when: moved meshes start from it."""
        if self._mover is None:
            return {}
        return {"meshed_centres": self._meshed_centres, "meshed_time": np.array(self._meshed_time)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Mesh again where the mesh in use was made."""
        if self._moving and "meshed_centres" in state:
            q = Configuration.unturned(state["meshed_centres"], self.case.configuration().radii)
            self._remesh(q, float(state["meshed_time"]))

    def _moved(self, q: Configuration, t: float) -> FluidMesh:
        """The mesh in use, moved to q and t, or a new one where it would be too distorted."""
        if self._mover is not None:
            container, duration = self._container(), t - self._meshed_time
            places = self.units.scaled_places(q.centres)
            quality = self._mover.move(places, lambda e: container.carried(e, duration))
            if quality is not None:
                return self._mover.fluid.moved(quality, container.at(t))
        return self._remesh(q, t)

    def _remesh(self, q: Configuration, t: float) -> FluidMesh:
        self._workspace.close()
        if self._mover is not None:
            self._mover.close()
        self._mover = Mover(self.scaled_mesh(q, t), self.units.scaled_places(q.centres))
        self._meshed_centres, self._meshed_time = q.centres, t
        return self._mover.fluid


def boundary_of(case: Case, t: float) -> Boundary:
    """What holds on the walls of a case at time t."""
    velocities = {wall: _field(velocity) for wall, velocity in case.wall_velocity(t).items()}
    return Boundary(velocities, case.wall_pressure(), None, *case.domain.mean_drive())


def wall_kinks(case: Case) -> set[float]:
    """The times between which the velocities of the walls are linear, at least one."""
    return set[float]().union(*(wall.kinks() for wall in case.domain.walls.values())) or {0.0}


def singular_corners(case: Case) -> Array:
    """Where in the plane the flow is singular at some time, (n, 2): walls are linear between their kinks."""
    container = case.container()
    if container.dimension == 3:
        return np.empty((0, 3))
    pairs = {pair for t in wall_kinks(case) for pair in singular(container, boundary_of(case, t))}
    meetings = container.meetings()
    return np.concatenate([np.empty((0, 2)), *(meetings[pair] for pair in sorted(pairs))])


def _field(wall: WallVelocity) -> Field:
    """u(x) = velocity + shear h e_x with the last coordinate h, points (n, d) -> (n, d)."""

    def u(x: Array) -> Array:
        values = np.tile(wall.velocity, (len(x), 1))
        values[:, 0] += wall.shear * x[:, -1]
        return values

    return u
