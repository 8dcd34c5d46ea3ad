"""Solve to a tolerance: refine where the estimated error says that it matters.

Three sizes make a mesh: along the gaps, around the bodies, and the growth away from them. Each round
divides every one of them in turn by STEP, and keeps the change that lowers the estimate most; sizes that help
are also tried all together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil
from typing import Protocol

from fsi.bodies.configuration import Configuration, Motion
from fsi.case.case import Case
from fsi.case.checks.determined import require_determined_at_rest
from fsi.case.sections import Discretisation
from fsi.errors import SolveError
from fsi.observables.error_estimate import ErrorEstimate
from fsi.observables.flow_scales import flow_scales
from fsi.stokes.error import estimate_errors, relative_errors
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

STEP = 1.5
HELPS = 0.9  # a size helps if it lowers the estimate below this part of it
ROUNDS = 8
MOST_UNKNOWNS = 400_000
HIGHEST_DEGREE = 4
SIZES = ("cells_per_gap", "cells_per_circle", "growth")


class Trial(Protocol):
    """What was computed with the sizes of a case, and how accurate it is."""

    @property
    def case(self) -> Case:
        """With the sizes that were used."""

    @property
    def error(self) -> float:
        """The largest, relative."""

    @property
    def dofs(self) -> int:
        """Number of unknowns."""


@dataclass(frozen=True, slots=True)
class Solved:
    """A case with the sizes that were used, its solution, its errors, and the largest one, relative."""

    case: Case
    solution: StokesSolution
    errors: ErrorEstimate
    error: float

    @property
    def dofs(self) -> int:
        """Number of unknowns."""
        return self.solution.dofs


def solve_with_errors(case: Case) -> Solved:
    """The solution of a case at time 0 with its estimated errors, refined to its tolerance if it has one.

    Bodies have no inertia here: free ones have the velocity that they would soon reach.

    Raises:
        InputError: only inertia determines the motion.
        MeshError, SolveError: as `StokesModel`; or the tolerance is not reached.
    """
    require_determined_at_rest(case)
    q = case.configuration()
    motion = case.motion_at(q, 0.0)
    tolerance = case.discretisation.tolerance
    if tolerance is None:
        return _solved(case, q, 0.0, motion)
    return refined(case, q, 0.0, motion, tolerance)


def refined(case: Case, q: Configuration, t: float, motion: Motion, tolerance: float) -> Solved:
    """The solution at q and t with sizes that bring the largest relative error below the tolerance.

    Args:
        case: with the sizes to begin with.
        q: the bodies.
        t: the time.
        motion: what holds and drives the bodies.
        tolerance: in (0, 1).

    Raises:
        MeshError, SolveError: as `StokesModel`; or the tolerance is not reached.
    """
    return refine(case, lambda case: _solved(case, q, t, motion), tolerance)


def refine[T: Trial](case: Case, solved: Callable[[Case], T], tolerance: float) -> T:
    """What `solved` gives with sizes that bring its error below the tolerance.

    Raises:
        MeshError, SolveError: as `solved`; or the tolerance is not reached.
    """
    best = solved(case)
    for _ in range(ROUNDS):
        if best.error <= tolerance or best.dofs > MOST_UNKNOWNS or case.domain.mesh is not None:
            break
        better = _better(best, solved)
        if better.error >= best.error:
            break
        best = better
    if best.error > tolerance:
        raise _missed(best, tolerance)
    return best


def _solved(case: Case, q: Configuration, t: float, motion: Motion) -> Solved:
    model = StokesModel(case)
    solution = model.of_degree(case.discretisation.degree, q, t, motion)
    errors = estimate_errors(model, q, t, solution, motion)
    found = relative_errors(solution, errors, motion.held, q.arms, flow_scales(case, t))
    return Solved(case, solution, errors, max(found.values(), default=0.0))


def _better[T: Trial](best: T, solved: Callable[[Case], T]) -> T:
    """The best of the meshes one step finer; all three sizes at once where no single one helps."""
    each = {size: solved(_finer(best.case, (size,))) for size in SIZES}
    helpful = tuple(size for size, trial in each.items() if trial.error < HELPS * best.error)
    trials = list(each.values())
    if len(helpful) != 1:
        trials.append(solved(_finer(best.case, helpful or SIZES)))
    return min(trials, key=lambda trial: trial.error)


def _finer(case: Case, sizes: tuple[str, ...]) -> Case:
    """The case with some of its sizes one step finer."""
    given = case.discretisation
    finer = {
        "cells_per_gap": STEP * given.cells_per_gap,
        "cells_per_circle": ceil(STEP * given.cells_per_circle),
        "growth": given.growth / STEP,
    }
    changed = given.model_copy(update={size: finer[size] for size in sizes})
    return case.model_copy(update={"discretisation": changed})


def _missed(best: Trial, tolerance: float) -> SolveError:
    given, mesh = best.case.discretisation, best.case.domain.mesh
    if mesh is not None:
        return SolveError(
            f"discretisation.tolerance = {tolerance:g}: the estimated error is {best.error:.1e} on the mesh "
            f"of domain.mesh = {mesh}, which is not refined; raise it, or give a finer mesh"
        )
    if best.dofs > MOST_UNKNOWNS:
        limit = f"{best.dofs} unknowns are the most that is tried"
    else:
        limit = "a finer mesh does not lower it enough"
    remedy = "raise it" if given.degree == HIGHEST_DEGREE else f"raise it, or degree above {given.degree}"
    return SolveError(
        f"discretisation.tolerance = {tolerance:g}: the estimated error came down to {best.error:.1e} with "
        f"{_text(given)}, and {limit}; {remedy}"
    )


def _text(given: Discretisation) -> str:
    return ", ".join(f"{size} = {getattr(given, size):.4g}" for size in SIZES)
