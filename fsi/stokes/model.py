"""The resolved model of a case: configuration and time in, velocities of the bodies and error bars out."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration, Inertia, Motion
from fsi.bodies.opened import way_out
from fsi.bodies.resolved_gaps import require_resolved
from fsi.case.case import Case
from fsi.integration.errors import StepErrors
from fsi.integration.state import Instant
from fsi.meshes.build import FluidMesh, Made, build
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.moving.move import Mover
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial.grading import COARSEST
from fsi.observables.bars import Compared, DrivenBodies, motion_of, step_errors
from fsi.stokes.comparisons import Comparison, comparisons
from fsi.stokes.laws import pair_laws
from fsi.stokes.problem import SolverOptions, StokesProblem
from fsi.stokes.refusal import explained
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import Clock, solve
from fsi.stokes.solvers.workspace import Workspace
from fsi.stokes.units import Units
from fsi.stokes.walls import boundary_of, singular_corners, singular_pairs, surfaces_of

# What laws below a gap miss grows like its root or faster: 1 - 2^(-1/2) of it is seen at half the gap.
OF_LAWS = 3.5
# Fluid that is shut in leaves by several gaps once they are opened, but through the widest of them before.
WAYS_OUT = 3.0


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
        self._meshed, self._meshed_time = case.configuration(), 0.0
        self._made: tuple[object, Made] = None, {}  # where straight cells were made, and these
        self._workspace = Workspace()
        self.units = Units.of(case)
        self._corners, self._edges = np.empty((0, 2)), singular_pairs(case)
        if case.dimension == 2:
            self._corners, self._edges = self.units.scaled_places(singular_corners(case)), ()

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> StokesSolution:
        """The flow at q and t. Raises MeshError; SolveError: a gap too narrow, or the solve is refused."""
        if self.case.domain.mesh is None:
            require_resolved(q, t, self._around(q, t), self.case.names)
        clock, self._made = Clock(), (None, {})  # only what follows takes the same straight cells
        fluid = self._moved(q, t) if self._moving else self.scaled_mesh(q, t)
        clock.lap("mesh")
        motion, inertia = self.case.motion_at(q, t).under(inertia)
        problem = replace(self.problem(fluid, q, t, motion), inertia=inertia)
        workspace = self._workspace if self._moving else None
        with explained(problem, self.case.names, self.units.origin):
            found = solve(self.units.scaled(problem), self.options, clock, workspace)
        return self.units.user_solution(found, problem)

    def compared(self, comparison: Comparison, q: Configuration, t: float, motion: Motion) -> StokesSolution:
        """A flow from which that of the case differs by a part of its error."""
        clock, fluid = Clock(), self.compared_mesh(comparison, q, t)
        return self._solved(self.problem(fluid, q, t, motion), comparison.degree, clock)

    def of_degree(self, degree: int, q: Configuration, t: float, motion: Motion) -> StokesSolution:
        """The flow with elements and curved cells of another degree, on a new mesh of the same simplices."""
        clock = Clock()
        return self._solved(self.problem(self.scaled_mesh(q, t, degree), q, t, motion), degree, clock)

    def _factor_of_laws(self, below: float, q: Configuration, t: float) -> float:
        """By which the error of laws below a gap c is larger than what half the gap changes.

        In the plane fluid that gaps of d shut in gets out as d^(5/2): by how much opened gaps change that,
        ((c/d)^(5/2) - 1) / (2^(5/2) - 1) times as much as half of them.
        """
        unknown: float = ((below / self._way_out(below, q, t)) ** 2.5 - 1.0) / (2.0**2.5 - 1.0)
        return max(OF_LAWS, WAYS_OUT * unknown)

    def _way_out(self, below: float, q: Configuration, t: float) -> float:
        """d of the gaps that shut fluid in most tightly, `below` where none narrower do, as in space."""
        if self.case.geometry != "planar":
            return below
        return way_out(q, self._around(q, t), below, tuple(boundary_of(self.case, t).velocities))

    def _of_half_the_gap(self, below: float, q: Configuration, t: float, motion: Motion) -> StokesSolution:
        """The flow in which laws act below half the gap: it differs by most of what they miss."""
        half = self.case.lubrication.model_copy(update={"below": 0.5 * below})
        model = StokesModel(self.case.model_copy(update={"lubrication": half}))
        return model.of_degree(self.options.degree, q, t, motion)

    def _solved(self, problem: StokesProblem, degree: int, clock: Clock) -> StokesSolution:
        with explained(problem, self.case.names, self.units.origin):
            found = solve(self.units.scaled(problem), replace(self.options, degree=degree), clock)
        return self.units.user_solution(found, problem)

    def errors(
        self, q: Configuration, t: float, instant: Instant, motion: Motion | None = None
    ) -> StepErrors:
        """The estimated errors of an instant of this model at q and t; a solve or two more, collective.

        Where laws act below a gap one more solve, with half of this gap, tells what they miss.

        motion: what held and drove the bodies; None: that of the case at this instant. Raises MeshError,
        SolveError: as for the flow, with the other degree.
        """
        motion = motion or motion_of(self.case, q, t, instant)
        others = [
            Compared(self.compared(each, q, t, motion), each.factor, each.chance, each.chance_of_stress)
            for each in comparisons(self.case)
        ]
        if (below := self.case.lubrication.below) is not None:
            of_half = self._of_half_the_gap(below, q, t, motion)
            others.append(Compared(of_half, self._factor_of_laws(below, q, t)))
        bodies = DrivenBodies(self.case, q, t, motion)
        return step_errors(bodies, cast(StokesSolution, instant), *others)  # this model gave it

    def problem(self, fluid: FluidMesh, q: Configuration, t: float, motion: Motion) -> StokesProblem:
        """What the case asks for at q and t, without inertia, on a mesh in the units of the model."""
        case, boundary = self.case, boundary_of(self.case, t)
        container, mu, moment = self._around(q, t), case.fluid.viscosity, case.interaction_moment(q, t)
        meshed = case.meshed_at(q, t)
        problem = StokesProblem(
            fluid, container, meshed, motion, boundary, mu, interaction=moment, surfaces=surfaces_of(case)
        )
        if (below := case.lubrication.below) is None:
            return problem
        from fsi.lubrication.below import OpenedGaps

        gaps = OpenedGaps(q, meshed, container, below, tuple(boundary.velocities), case.spheres, mu)
        laws = replace(pair_laws(gaps.rates(), problem, q), shut_in=self._way_out(below, q, t) < below)
        return replace(problem, laws=laws)

    def mesh(self, q: Configuration, t: float = 0.0) -> FluidMesh:
        """A new mesh around the bodies at q and t, or the user's own."""
        return self.units.user_mesh(self.scaled_mesh(q, t), self._around(q, t))

    def scaled_mesh(self, q: Configuration, t: float = 0.0, order: int | None = None) -> FluidMesh:
        """The same mesh in the units of the model; of the case's order if not given."""
        case, order = self.case, order or self.case.discretisation.degree
        if case.domain.mesh is None:
            return self._built(q, t, self.resolution, order)
        from fsi.meshes.files.read import read_mesh

        domain = FluidDomain(self._around(q, t), q.centres, q.radii)
        fluid = read_mesh(Path(case.domain.mesh), case.names, domain, order)
        return fluid.scaled(1.0 / self.units.length, self._container().at(t, q.strain))

    def compared_mesh(self, comparison: Comparison, q: Configuration, t: float = 0.0) -> FluidMesh:
        """The mesh for `compared`; one of the model's own where it is to be another one."""
        if comparison.finer == 1.0:
            return self.scaled_mesh(q, t, comparison.degree)
        coarsest = COARSEST if q.dimension == 3 else self.resolution.growth
        growth = min(self.resolution.growth, coarsest) / comparison.finer
        return self._built(q, t, replace(self.resolution, growth=growth), comparison.degree)

    def _built(self, q: Configuration, t: float, resolution: Resolution, order: int) -> FluidMesh:
        """A mesh in the units of the model, whatever the user has.

        Flows of another degree at the same instant have cells that are curved from the same straight ones.
        """
        where = t, q.strain, *(x.tobytes() for x in (q.centres, q.radii, q.angles))
        if where != self._made[0]:
            self._made = where, {}
        here = self.units.scaled_configuration(self.case.meshed_at(q, t))
        container = self._container().at(t, q.strain)
        try:
            domain = FluidDomain(
                container, here.centres, here.radii, self._corners, self._edges, here.placed, here.standing
            )
            return build(domain, resolution, order, self._made[1])
        except MeshError as error:
            raise error.in_units(self.units.length, self.units.origin) from error

    def _around(self, q: Configuration, t: float) -> Container:
        """What encloses the fluid around the bodies at q and t, in the units of the case."""
        return self.case.container().at(t, q.strain)

    def _container(self) -> Container:
        """At time 0, in the units of the model."""
        return self.units.scaled_container(self.case.container())

    def state(self) -> dict[str, NDArray[Any]]:
        """Where the bodies were when the mesh in use was made: moved meshes start from it."""
        if self._mover is None:
            return {}
        meshed = {"meshed_centres": self._meshed.centres, "meshed_time": np.array(self._meshed_time)}
        meshed["meshed_strain"] = np.array(self._meshed.strain)
        return meshed | ({"meshed_angles": self._meshed.angles} if self._meshed.shaped else {})

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Mesh again where the mesh in use was made."""
        if self._moving and "meshed_centres" in state:
            q = self.case.configuration()
            angles = state["meshed_angles"] if q.shaped else q.angles
            strain = float(state["meshed_strain"])
            q = replace(q, centres=state["meshed_centres"], angles=angles, strain=strain)
            self._remesh(q, float(state["meshed_time"]))

    def _moved(self, q: Configuration, t: float) -> FluidMesh:
        """The mesh in use, moved to q and t, or a new one where it would be too distorted."""
        if self._mover is not None:
            container, duration = self._container(), t - self._meshed_time
            strain = q.strain - self._meshed.strain
            places = self.units.scaled_places(self.case.meshed_at(q, t).centres)
            angles = q.angles if q.shaped else None
            quality = self._mover.move(places, lambda e: container.carried(e, duration, strain), angles)
            if quality is not None:
                return self._mover.fluid.moved(quality, container.at(t, q.strain))
        return self._remesh(q, t)

    def _remesh(self, q: Configuration, t: float) -> FluidMesh:
        self._workspace.close()
        if self._mover is not None:
            self._mover.close()
        here = self.units.scaled_configuration(self.case.meshed_at(q, t))
        self._mover = Mover(self.scaled_mesh(q, t), here.centres, here.placed, here.standing)
        self._meshed, self._meshed_time = q, t
        return self._mover.fluid
