"""A case of the model of pores at time 0 with its error bars, with as many modes as its tolerance needs."""

from dataclasses import dataclass

from fsi.case.case import Case
from fsi.case.checks.determined import require_determined_at_rest
from fsi.integration.errors import ErrorEstimate
from fsi.observables.bars import DrivenBodies
from fsi.pores.fineness import Fineness
from fsi.pores.instant import PoreInstant
from fsi.pores.model import adapted, driven, errors_of


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
    q, fineness = case.configuration(), Fineness.even(case.pores.modes)
    bodies = DrivenBodies(case, q, 0.0, case.motion_at(q, 0.0))
    if case.tolerance is not None:
        found, estimated = adapted(bodies, case.tolerance, fineness)
    else:
        found = driven(bodies, fineness)
        estimated = errors_of(bodies, found)
    return SolvedPores(case, found, estimated.errors)
