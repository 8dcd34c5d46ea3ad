"""The levels by name: what steps a case of each, and which of them give velocities at an instant.

Modules are imported where they are needed: only the resolved model wants DOLFINx, only runs want steppers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple, Protocol, cast

import numpy as np

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.checks.determined import check_strayed_lattice
from fsi.case.checks.own_mesh import check_own_mesh
from fsi.errors import InputError
from fsi.integration.state import Instant

if TYPE_CHECKING:
    from fsi.integration.errors import ErrorEstimate
    from fsi.integration.evolution import Evolution, SteppedEvolution
    from fsi.integration.state import Advance, Model, Scheme
    from fsi.observables.resistance import Resistance, ResistanceErrors


def require_instant(case: Case) -> None:
    """Raise InputError where the level of a case has no velocities at an instant: it steps by itself."""
    if not case.level.viscous:
        raise InputError(
            f'model = "{case.model}": has no velocities at an instant, only a motion in time; use `fsi run`'
        )


def make_model(case: Case) -> Model:
    """The model that gives the velocities of the bodies of a case at an instant. Raises InputError."""
    require_instant(case)
    return INSTANTS[case.model](case)


class FlowInstant(Instant, Protocol):
    """An instant of a level with a flow."""

    @property
    def checks(self) -> Mapping[str, float]:
        """The relative defects of its identities."""

    @property
    def dofs(self) -> int:
        """Unknowns."""

    @property
    def mesh_instead(self) -> str:
        """The size that was taken as those of the case gave no valid mesh, "" where they did."""

    def velocity(self, x: Array) -> Array:
        """u (n, d) at points x (n, d), the same on all ranks; NaN outside the fluid; collective."""

    def evaluate(self, x: Array) -> tuple[Array, Array]:
        """The same u, and p (n,). Raises InputError: there is no p."""


class SolvedInstant(Protocol):
    """A case solved at time 0."""

    @property
    def case(self) -> Case:
        """What was solved: with a tolerance, refined to it."""

    @property
    def solution(self) -> FlowInstant:
        """The flow."""

    @property
    def errors(self) -> ErrorEstimate:
        """Its estimated errors."""


class SolvedMatrix(Protocol):
    """The resistance matrix of a case with its estimated errors."""

    @property
    def case(self) -> Case:
        """What was solved: with a tolerance, refined to it."""

    @property
    def resistance(self) -> Resistance:
        """The matrix."""

    @property
    def errors(self) -> ResistanceErrors:
        """Of its entries."""


class FlowSolvers(NamedTuple):
    """What levels with a flow do besides, at time 0 and without inertia; all of it collective.

    Attributes:
        solve: the flow with its estimated errors. Raises InputError: only inertia determines the motion;
            MeshError, SolveError: the solve fails, or the tolerance of the case is not reached.
        resistance: the matrix of all bodies with the sizes or modes of the case, whatever its tolerance.
            Raises alike; InputError where bodies alone determine no flow.
        resistance_with_errors: the same with its estimated errors, refined to the tolerance of the case.
    """

    solve: Callable[[Case], SolvedInstant]
    resistance: Callable[[Case], Resistance]
    resistance_with_errors: Callable[[Case], SolvedMatrix]


def flow_solvers(case: Case) -> FlowSolvers:
    """Those of the level of a case, which has a flow."""
    return FLOWS[case.model]()


def make_evolution(case: Case) -> Evolution:
    """What moves the bodies of a case in time. Raises InputError: no [time], or a mesh that they leave."""
    _ = case.timing
    check_strayed_lattice(case)
    if case.level.meshed:
        check_own_mesh(case)
    return EVOLUTIONS[case.model](case) if case.model in EVOLUTIONS else stepped(case, make_model(case))


def stepped(case: Case, model: Model) -> SteppedEvolution:
    """The motion of a case with a model that gives velocities at an instant."""
    from fsi.integration.evolution import SteppedEvolution
    from fsi.integration.strayed import Strayed

    estimated = case.output.error_estimates or case.tolerance is not None
    q, stepper = case.configuration(), make_stepper(case, model)
    strayed = Strayed(case.masses(), case.motion_at) if case.output.error_estimates else None
    return SteppedEvolution(stepper, case.names, q, estimated, strayed)


def make_scheme(case: Case) -> Scheme | None:
    """What makes the steps of a case from velocities; None where its model makes them."""
    from fsi.integration.schemes import Beginning

    make, masses, U = case.scheme.make, case.masses(), case.initial_velocity()
    if make is None:
        return None
    return make(Beginning(np.zeros_like(U) if masses is None else masses, U, case.timing.smallest_step))


def make_stepper(case: Case, model: Model) -> Advance:
    """The stepper that a case asks for by `time.scheme`, or by whether any body has a mass."""
    from fsi.integration.state import Schedule
    from fsi.integration.stepper import Refinable, RefiningStepper, Stepper

    time, scheme = case.timing, make_scheme(case)
    schedule = Schedule(time.end, case.kinks(), case.output.interval)
    if scheme is None:
        from fsi.reduced.distance_model import DistanceModel
        from fsi.reduced.distance_stepper import DistanceStepper

        assert time.step is not None  # checked with the case, as the level
        return DistanceStepper(cast(DistanceModel, model), case.container(), schedule, time.step)
    stepper = Stepper(
        model=model,
        scheme=scheme,
        container=case.container(),
        names=case.names,
        schedule=schedule,
        tolerance=time.tolerance,
        gap_loss=time.gap_loss,
        smallest_step=time.smallest_step,
        first_step=time.first_step,
    )
    if case.tolerance is None:
        return stepper
    assert isinstance(model, Refinable)  # as those of all levels with a tolerance
    return RefiningStepper(stepper, model, case.tolerance)


def _resolved(case: Case) -> Model:
    from fsi.stokes.adapt import RefinedModel
    from fsi.stokes.model import StokesModel

    return StokesModel(case) if case.discretisation.tolerance is None else RefinedModel(case)


def _pores(case: Case) -> Model:
    from fsi.pores.model import PoreModel

    return PoreModel(case)


def _reduced(case: Case) -> Model:
    from fsi.reduced.distance_model import DistanceModel
    from fsi.reduced.model import ReducedModel

    fixed = case.time is not None and case.scheme.fixed
    return DistanceModel(case) if fixed else ReducedModel(case)


def _gluey(case: Case) -> Evolution:
    from fsi.gluey.evolution import GlueyEvolution

    return GlueyEvolution(case)


def _macroscopic(case: Case) -> Evolution:
    from fsi.macroscopic.evolution import MacroscopicEvolution

    return MacroscopicEvolution(case)


def _flow_of_cells() -> FlowSolvers:
    from fsi.stokes.adapt import solve_with_errors
    from fsi.stokes.resistance import case_resistance, resistance_with_error

    return FlowSolvers(solve_with_errors, case_resistance, resistance_with_error)


def _flow_of_pores() -> FlowSolvers:
    from fsi.pores.accuracy import solve_with_errors
    from fsi.pores.resistance import case_resistance, resistance_with_error

    return FlowSolvers(solve_with_errors, case_resistance, resistance_with_error)


INSTANTS: dict[str, Callable[[Case], Model]] = {
    "resolved": _resolved,
    "pores": _pores,
    "reduced": _reduced,
}
FLOWS: dict[str, Callable[[], FlowSolvers]] = {"resolved": _flow_of_cells, "pores": _flow_of_pores}
EVOLUTIONS: dict[str, Callable[[Case], Evolution]] = {"gluey": _gluey, "macroscopic": _macroscopic}
