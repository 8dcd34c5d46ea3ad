"""The model of pores of a case: configuration and time in, velocities of the bodies out.

Every instant has its own pores and its own matrix, so that nothing need be remembered but, with
`pores.tolerance`, how many modes necks have by now, and where. All ranks compute the same.
"""

from collections.abc import Mapping
from time import process_time
from typing import Any, ClassVar, cast

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration, Inertia
from fsi.bodies.resolved_gaps import require_resolved
from fsi.case.case import Case
from fsi.errors import SolveError
from fsi.integration.errors import StepErrors
from fsi.integration.state import Instant
from fsi.observables.bars import Compared, DrivenBodies, motion_of, step_errors
from fsi.pores.adapt import adapt
from fsi.pores.bars import CHANCE, CHANCE_OF_FLOW, SAFETY, other_modes
from fsi.pores.fineness import Fineness
from fsi.pores.first_use import tell_of_compilation
from fsi.pores.fluid_discs import pores_without_wide
from fsi.pores.instant import PoreInstant
from fsi.pores.solve import PoreDrive, PoreLoading, solve_pores
from fsi.pores.stress import carried_stress
from fsi.pores.stressed import StressedLoading
from fsi.pores.surfaces import NoPoresError, surfaces_of
from fsi.pores.system import PoreSystem

# In a run bodies move on: a tolerance that is just reached would be missed in the next step.
MARGIN = 0.5


class PoreModel:
    """Pores between the bodies of a case, made anew for any configuration."""

    tolerance_key: ClassVar[str] = "pores.tolerance"
    remedy: str = ""

    def __init__(self, case: Case) -> None:
        """A model of the case, with its modes; nothing is computed yet."""
        self.case = case
        self.fineness = Fineness.even(case.pores.modes)
        self._known: tuple[Instant, StepErrors] | None = None

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> PoreInstant:
        """The flow at q and t. Raises SolveError: a gap too narrow, no pores there, a violated identity."""
        require_resolved(q, t, self.case.container().at(t, q.strain), self.case.names)
        motion, inertia = self.case.motion_at(q, t).under(inertia)
        return driven(DrivenBodies(self.case, q, t, motion), self.fineness, inertia)

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:
        """The estimated errors of an instant of this model; estimated once, by one solve with other modes."""
        if self._known is None or self._known[0] is not instant:
            bodies = DrivenBodies(self.case, q, t, motion_of(self.case, q, t, instant))
            self._known = instant, errors_of(bodies, _own(instant))
        return self._known[1]

    def refine(self, q: Configuration, t: float, instant: Instant) -> None:
        """Have more modes from now on, where they matter for an error well below the tolerance at q and t."""
        bodies = DrivenBodies(self.case, q, t, motion_of(self.case, q, t, instant))
        tolerance = MARGIN * (self.case.pores.tolerance or 1.0)
        found, _ = adapted(bodies, tolerance, Fineness.of(_own(instant).flow.system))
        self.fineness = Fineness.of(found.flow.system)

    def state(self) -> dict[str, NDArray[Any]]:
        """The modes in use, and where."""
        return {"modes": self.fineness.modes, "places": self.fineness.places}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `state` gave."""
        self.fineness = Fineness(state["places"], state["modes"])


def _own(instant: Instant) -> PoreInstant:
    """An instant that this model gave."""
    return cast(PoreInstant, instant)


def driven(bodies: DrivenBodies, fineness: Fineness, inertia: Inertia | None = None) -> PoreInstant:
    """The flow around bodies with modes by place. Raises SolveError: no pores, or a violated identity."""
    began = process_time()
    system = make_system(bodies, fineness)
    return _solved(bodies, system, inertia, process_time() - began)


def errors_of(bodies: DrivenBodies, instant: PoreInstant) -> StepErrors:
    """The estimated errors of an instant, by one solve with other modes. Raises SolveError."""
    began = process_time()
    modes, factor = other_modes(instant.flow.system)
    try:
        system = instant.flow.system.with_modes(modes)
    except NoPoresError as error:
        raise _named(bodies, error) from None
    other = _solved(bodies, system, None, process_time() - began)
    return step_errors(bodies, instant, Compared(other, factor, CHANCE, CHANCE, CHANCE_OF_FLOW))


def adapted(bodies: DrivenBodies, tolerance: float, fineness: Fineness) -> tuple[PoreInstant, StepErrors]:
    """The flow with all errors, over the largest result of their kind, below the tolerance, and these.

    Modes are added to a fineness pore by pore. Raises SolveError: the most whose error is known do not do.
    """
    drive, aim, system = drive_of(bodies), tolerance / SAFETY, make_system(bodies, fineness)
    while True:
        began = process_time()
        try:
            pair = adapt(system, drive, aim)
        except NoPoresError as error:
            raise _named(bodies, error) from None
        except SolveError as error:
            raise SolveError(f"pores.tolerance = {bodies.case.pores.tolerance!r}: {error}") from error
        of_finer, fine = drive.on(pair.fine.system), pair.fine
        if of_finer is not fine.loading:  # the stress is the same, not the speed
            fine = solve_pores(fine.system, of_finer)
        seconds = {"solve": process_time() - began}
        found, finer = (PoreInstant(bodies, flow, seconds) for flow in (pair.coarse, fine))
        found.require_sound()
        errors = step_errors(bodies, found, Compared(finer, SAFETY, CHANCE, CHANCE, CHANCE_OF_FLOW))
        largest = max(errors.relative.values(), default=0.0)
        if largest <= tolerance:
            for flow in (pair.coarse, fine):
                flow.system.factors.forget()
            return found, errors
        system, aim = pair.coarse.system, 0.5 * aim * tolerance / largest


def _solved(
    bodies: DrivenBodies, system: PoreSystem, inertia: Inertia | None, assembled: float
) -> PoreInstant:
    """The sound flow of a system that was assembled in so many seconds."""
    began = process_time()
    flow = solve_pores(system, drive_of(bodies, inertia).on(system))
    system.factors.forget()
    instant = PoreInstant(bodies, flow, {"assemble": assembled, "solve": process_time() - began})
    instant.require_sound()
    return instant


def make_system(bodies: DrivenBodies, fineness: Fineness) -> PoreSystem:
    """Pores and their matrix. Raises SolveError: no pores there, with the names of bodies and walls."""
    tell_of_compilation()
    surfaces = surfaces_of(bodies.q, bodies.case.container().at(bodies.t, bodies.q.strain))
    try:
        pores = pores_without_wide(surfaces)
        return PoreSystem.of(len(bodies.q), pores, fineness.at(pores), bodies.case.fluid.viscosity)
    except NoPoresError as error:
        raise _named(bodies, error) from None


def _named(bodies: DrivenBodies, error: NoPoresError) -> SolveError:
    """The error with the time, the names of bodies and walls, and a remedy."""
    problem = error.between([*bodies.case.names, *(f"wall {name}" for name in bodies.case.container().walls)])
    return SolveError(
        f'model = "pores" at t = {bodies.t:.9g}: no pores are found, as {problem}; give other places '
        '(bodies.position), another domain, or model = "resolved"'
    )


def drive_of(bodies: DrivenBodies, inertia: Inertia | None = None) -> PoreDrive:
    """Everything that drives the bodies of a case."""
    case, container, t = bodies.case, bodies.case.container(), bodies.t
    walls = np.zeros((len(container.walls), 3))
    for name, wall in case.wall_velocity(t).items():
        walls[container.walls.index(name), :2] = wall.velocity
    drive, gradient = case.domain.mean_drive(), container.mean_gradient
    loading = PoreLoading(
        bodies.motion, walls, gradient, drive.pressure_gradient, drive.net_flux, inertia
    )  # fmt: skip
    for name, stress in case.wall_stress(t).items():
        return StressedLoading(loading, stress, container.walls.index(name), container.volume)
    if drive.mean_stress is not None:
        stress = drive.mean_stress - float(carried_stress(bodies)[0, 1])
        return StressedLoading(loading, stress, None, container.volume)
    return loading
