"""A case of the model of pores at time 0 with its error bars, with as many modes as its tolerance needs."""

from dataclasses import dataclass
from time import process_time

from fsi.case.case import Case
from fsi.case.checks.determined import require_determined_at_rest
from fsi.errors import SolveError, apart
from fsi.integration.errors import ErrorEstimate
from fsi.observables.bars import Compared, DrivenBodies, step_errors
from fsi.pores.adapt import adapt
from fsi.pores.bars import SAFETY
from fsi.pores.instant import PoreInstant
from fsi.pores.model import PoreModel, loading_of, make_system


@dataclass(frozen=True, slots=True)
class SolvedPores:
    """The flow of a case with its estimated errors.

    Attributes:
        case: what was solved.
        solution: the flow; with a tolerance with more modes than the case has, where they are needed.
        errors: absolute.
    """

    case: Case
    solution: PoreInstant
    errors: ErrorEstimate


def solve_with_errors(case: Case) -> SolvedPores:
    """The flow of a case at time 0, without inertia; modes are added pore by pore until its tolerance holds.

    Raises InputError: only inertia determines the motion; SolveError: no pores, a violated identity, or the
    tolerance is not reached.
    """
    require_determined_at_rest(case)
    q = case.configuration()
    bodies, model = DrivenBodies(case, q, 0.0, case.motion_at(q, 0.0)), PoreModel(case)
    if case.tolerance is not None:
        return _adapted(bodies, case.tolerance)
    solution = model.driven(bodies, model.modes)
    return SolvedPores(case, solution, model.errors_of(bodies, solution, model.modes).errors)


def _adapted(bodies: DrivenBodies, tolerance: float) -> SolvedPores:
    """The flow with all errors, over the largest result of their kind, below the tolerance."""
    case, loading, aim = bodies.case, loading_of(bodies), tolerance / SAFETY
    system = make_system(bodies, case.pores.modes)
    while True:
        began = process_time()
        try:
            pair = adapt(system, loading, aim)
        except SolveError as error:
            raise SolveError(f"pores.tolerance = {tolerance!r}: {error}") from error
        seconds = {"solve": process_time() - began}
        solution, finer = (PoreInstant(bodies, flow, seconds) for flow in (pair.coarse, pair.fine))
        solution.require_sound()
        errors = step_errors(bodies, solution, Compared(finer, SAFETY))
        largest = max(errors.relative.values(), default=0.0)
        if largest <= tolerance:
            return SolvedPores(case, solution, errors.errors)
        system, aim = pair.coarse.system, 0.5 * aim * tolerance / largest


def missed(case: Case, error: float) -> SolveError:
    """The error of a tolerance that is not reached with the most modes."""
    tolerance = case.pores.tolerance or 0.0
    return SolveError(
        f"pores.tolerance = {tolerance!r}: with the most modes the estimated error is "
        f'{apart(error, tolerance)}; raise it, or give model = "resolved"'
    )


def with_modes(case: Case, modes: int) -> Case:
    """The case with so many modes."""
    return case.model_copy(update={"pores": case.pores.model_copy(update={"modes": modes})})
