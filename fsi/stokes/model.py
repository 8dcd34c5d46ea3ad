"""The resolved model of a case: configuration and time in, velocities of the bodies and error bars out."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, cast

from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration, Inertia, Motion
from fsi.bodies.opened import way_out
from fsi.bodies.resolved_gaps import require_resolved
from fsi.case.case import Case
from fsi.integration.errors import StepErrors
from fsi.integration.state import Instant
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.container import Container
from fsi.observables.bars import Compared, DrivenBodies, motion_of, step_errors
from fsi.stokes.comparisons import Comparison, comparisons
from fsi.stokes.meshes import CaseMeshes
from fsi.stokes.pair_laws import pair_laws
from fsi.stokes.problem import SolverOptions, StokesProblem
from fsi.stokes.refusal import explained
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import Clock, solve
from fsi.stokes.units import Units
from fsi.stokes.walls import boundary_of, surfaces_of

# What laws below a gap miss grows like the root of opened gaps or faster: with bodies moved apart half as far
# 1 - 2^(-1/2) of it is seen.
OF_LAWS = 3.5
# Fluid that is shut in leaves by several gaps once they are opened, but through the widest of them before.
WAYS_OUT = 3.0
# Gaps below which laws act: with less around a body in a round wall they miss more than half the way tells.
ROOM = 10.0


class StokesModel:
    """Meshes the fluid around the bodies and solves, for any configuration; collective over all ranks.

    Attributes:
        meshes: those of the case.
        options: how its flows are solved.
    """

    def __init__(self, case: Case, opening: float = 1.0) -> None:
        """A model of the case, with bodies moved apart as by `CaseMeshes`; nothing is meshed yet."""
        self.case, self.meshes = case, CaseMeshes(case, opening)
        sizes = case.discretisation
        self.options = SolverOptions(sizes.degree, sizes.formulation, sizes.solver)

    @property
    def units(self) -> Units:
        """In which flows are solved."""
        return self.meshes.units

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> StokesSolution:
        """The flow at q and t. Raises MeshError; SolveError: a gap too narrow, or the solve is refused."""
        if self.case.domain.mesh is None:
            require_resolved(q, t, self._around(q, t), self.case.names)
        clock, fluid = Clock(), self.meshes.mesh_in_use(q, t)
        clock.lap("mesh")
        motion, inertia = self.case.motion_at(q, t).under(inertia)
        problem = replace(self.problem(fluid, q, t, motion), inertia=inertia)
        workspace = self.meshes.workspace if self.meshes.moving else None
        with explained(problem, self.case.names, self.units.origin):
            found = solve(self.units.scaled(problem), self.options, clock, workspace)
        return self.units.user_solution(found, problem)

    def compared(self, comparison: Comparison, q: Configuration, t: float, motion: Motion) -> StokesSolution:
        """A flow from which that of the case differs by a part of its error."""
        clock, fluid = Clock(), self.meshes.compared_mesh(comparison, q, t)
        return self._solved(self.problem(fluid, q, t, motion), comparison.degree, clock)

    def of_degree(self, degree: int, q: Configuration, t: float, motion: Motion) -> StokesSolution:
        """The flow with elements and curved cells of another degree, on a new mesh of the same simplices."""
        clock = Clock()
        return self._solved(self.problem(self.meshes.scaled_mesh(q, t, degree), q, t, motion), degree, clock)

    def _factor_of_laws(self, below: float, q: Configuration, t: float) -> float:
        """By which the error of laws below a gap c is larger than what half the way to it changes.

        In the plane fluid that gaps of d shut in gets out as D^(5/2), D = c where they are opened and
        (c + d) / 2 half-way: by how much opened gaps change that, ((c/d)^(5/2) - 1) / ((c/D)^(5/2) - 1) times
        as much as half of the way.
        """
        out = self._way_out(below, q, t)
        half = 0.5 * (below + out)
        if half == below:
            return OF_LAWS
        unknown: float = ((below / out) ** 2.5 - 1.0) / ((below / half) ** 2.5 - 1.0)
        return max(OF_LAWS, WAYS_OUT * unknown)

    def _way_out(self, below: float, q: Configuration, t: float) -> float:
        """d of the gaps that shut fluid in most tightly, `below` where none narrower do, as in space."""
        if self.case.geometry != "planar":
            return below
        return way_out(q, self._around(q, t), below, tuple(boundary_of(self.case, t).velocities))

    def _parts(self, below: float, q: Configuration) -> tuple[float, ...]:
        """Of the way to where laws have the bodies: half of it tells most of what they miss.

        All gaps are opened by the same part. With half of c instead narrow ones would still be opened and
        others no longer, whose errors may have opposite signs and in that difference cancel.

        Where a body has little room in a round wall what c and half-way miss may be alike by chance, and a
        quarter tells as well.
        """
        spheres = [sphere.radius for sphere in self.case.container().spheres if sphere is not None]
        tight = len(spheres) > 0 and min(spheres) - q.radii.max(initial=0.0) < ROOM * below
        return (0.5, 0.25) if tight else (0.5,)

    def _solved(self, problem: StokesProblem, degree: int, clock: Clock) -> StokesSolution:
        with explained(problem, self.case.names, self.units.origin):
            found = solve(self.units.scaled(problem), replace(self.options, degree=degree), clock)
        return self.units.user_solution(found, problem)

    def errors(
        self, q: Configuration, t: float, instant: Instant, motion: Motion | None = None
    ) -> StepErrors:
        """The estimated errors of an instant of this model at q and t; a solve or two more, collective.

        Where laws act below a gap one more solve or two, with bodies moved apart less, tell what they miss.

        motion: what held and drove the bodies; None: that of the case at this instant. Raises MeshError,
        SolveError: as for the flow, with the other degree.
        """
        motion = motion or motion_of(self.case, q, t, instant)
        others = [
            Compared(
                self.compared(each, q, t, motion),
                each.factor,
                each.chance,
                each.chance_of_stress,
                chance_of_free=each.chance_of_free,
            )
            for each in comparisons(self.case)
        ]
        if (below := self.case.lubrication.below) is not None:
            factor = self._factor_of_laws(below, q, t)
            for part in self._parts(below, q):
                nearer = StokesModel(self.case, part).of_degree(self.options.degree, q, t, motion)
                others.append(Compared(nearer, factor))
        bodies = DrivenBodies(self.case, q, t, motion, self.meshes.rounded(q, t))
        return step_errors(bodies, cast(StokesSolution, instant), *others)  # this model gave it

    def problem(self, fluid: FluidMesh, q: Configuration, t: float, motion: Motion) -> StokesProblem:
        """What the case asks for at q and t, without inertia, on a mesh in the units of the model."""
        case, boundary = self.case, boundary_of(self.case, t)
        container, mu, moment = self._around(q, t), case.fluid.viscosity, case.interaction_moment(q, t)
        meshed = self.meshes.places(q, t)
        problem = StokesProblem(
            fluid, container, meshed, motion, boundary, mu, interaction=moment, surfaces=surfaces_of(case)
        )
        if (below := case.lubrication.below) is None:
            return problem
        from fsi.lubrication.below import OpenedGaps

        gaps = OpenedGaps(q, meshed, container, below, tuple(boundary.velocities), case.spheres, mu)
        laws = pair_laws(gaps, boundary.velocities, problem.flow_gradient)
        laws = replace(laws, shut_in=self._way_out(below, q, t) < below)
        return replace(problem, laws=laws)

    def _around(self, q: Configuration, t: float) -> Container:
        """What encloses the fluid around the bodies at q and t, in the units of the case."""
        return self.case.container().at(t, q.strain)

    def state(self) -> dict[str, NDArray[Any]]:
        """What the meshes keep."""
        return self.meshes.state()

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `state` gave."""
        self.meshes.restore(state)
