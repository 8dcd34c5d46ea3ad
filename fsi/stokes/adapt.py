"""Solve, or run, to a tolerance: refine where the estimated error says that it matters.

Three sizes make a mesh: along the gaps, around the bodies, and the growth away from them, which is also that
away from corners where the data of walls jump, and says how small cells are there. Each round divides every
one of them in turn by STEP, and keeps the change that lowers the estimate most; sizes that help are also
tried all together.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import ceil
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration, Inertia, Motion
from fsi.case.case import Case
from fsi.case.checks.determined import require_determined_at_rest
from fsi.case.checks.work import bytes_of, finer_by
from fsi.case.sections import HIGHEST_DEGREE
from fsi.errors import InputError, SolveError, apart
from fsi.integration.errors import ErrorEstimate, StepErrors
from fsi.integration.state import Instant
from fsi.machine.resources import memory, size
from fsi.observables.bars import motion_of
from fsi.stokes.comparisons import comparisons
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

STEP = 1.5
HELPS = 0.9  # a size helps if it lowers the estimate below this part of it
ROUNDS = 8
MOST_UNKNOWNS = 400_000
SIZES = ("cells_per_gap", "cells_per_circle", "growth")
# In a run bodies move on: a tolerance that is just reached would be missed in the next step.
MARGIN = 0.5


@dataclass(frozen=True, slots=True)
class Refinement:
    """A case with the sizes that were used, the largest estimated relative error, and the unknowns."""

    case: Case
    error: float
    dofs: int


@dataclass(frozen=True, slots=True)
class Solved(Refinement):
    """The solution of the case, and its estimated errors."""

    solution: StokesSolution
    errors: ErrorEstimate


def solve_with_errors(case: Case) -> Solved:
    """The solution of a case at time 0 with its estimated errors, refined to its tolerance if it has one.

    Bodies have no inertia here: free ones have the velocity that they would soon reach.

    Raises InputError: only inertia determines the motion, or the tolerance is one of an infinite dissipation;
    MeshError, SolveError: as `StokesModel`, or the tolerance is not reached.
    """
    require_determined_at_rest(case)
    q = case.configuration()
    motion = case.motion_at(q, 0.0)
    tolerance = case.discretisation.tolerance
    return _solved(case, q, 0.0, motion) if tolerance is None else refined(case, q, 0.0, motion, tolerance)


def refined(case: Case, q: Configuration, t: float, motion: Motion, tolerance: float) -> Solved:
    """The solution at q and t with sizes, first those of the case, that reach the tolerance; see `refine`."""
    return refine(case, lambda case: _solved(case, q, t, motion), tolerance)


def refine[T: Refinement](case: Case, solved: Callable[[Case], T], tolerance: float) -> T:
    """What `solved` gives with sizes that bring its error below the tolerance; SolveError if none do.

    Sizes that this machine has no memory for are not tried.
    """
    best = solved(case)
    for _ in range(ROUNDS):
        if best.error <= tolerance or best.dofs > MOST_UNKNOWNS or case.domain.mesh is not None:
            break
        better = _better(best, solved)
        if better is None or better.error >= best.error:
            break
        best = better
    if best.error > tolerance:
        raise _missed(best, tolerance)
    return best


def _solved(case: Case, q: Configuration, t: float, motion: Motion) -> Solved:
    model = StokesModel(case)
    solution = model.of_degree(case.discretisation.degree, q, t, motion)
    estimated = model.errors(q, t, solution, motion)
    if case.discretisation.tolerance is not None and not len(q) and np.isinf(solution.dissipation):
        raise InputError(
            f"discretisation.tolerance = {case.discretisation.tolerance!r}: without bodies it is that of the "
            "dissipation, which is infinite here; drop it"
        )
    largest = max(estimated.relative.values(), default=0.0)
    return Solved(case, largest, solution.dofs, solution, estimated.errors)


def _better[T: Refinement](best: T, solved: Callable[[Case], T]) -> T | None:
    """The best of the meshes one step finer; all three sizes at once where no single one helps.

    None where this machine has room for none of them.
    """
    singles = {name: _finer(best.case, (name,)) for name in SIZES}
    trials = {name: solved(finer) for name, finer in singles.items() if _has_room(best, finer)}
    helpful = tuple(name for name, trial in trials.items() if trial.error < HELPS * best.error)
    together = _finer(best.case, helpful or SIZES)
    found = list(trials.values())
    if len(helpful) != 1 and _has_room(best, together):
        found.append(solved(together))
    return min(found, key=lambda trial: trial.error, default=None)


def _has_room(best: Refinement, finer: Case) -> bool:
    """Whether a finer mesh, with the flows that it is compared with, fits into the memory of this machine."""
    return _bytes_of(best, finer) <= memory()


def _bytes_of(best: Refinement, finer: Case) -> float:
    """What the largest solve for a finer mesh will need; its unknowns follow from those of the one before."""
    degree = max(finer.discretisation.degree, *(other.degree for other in comparisons(finer)))
    return bytes_of(finer, best.dofs * finer_by(best.case, _of_sizes(finer, {"degree": degree})))


def _finer(case: Case, sizes: tuple[str, ...]) -> Case:
    now = case.discretisation
    finer: dict[str, float] = {
        "cells_per_gap": STEP * now.cells_per_gap,
        "cells_per_circle": ceil(STEP * now.cells_per_circle),
        "growth": now.growth / STEP,
    }
    return _of_sizes(case, {size: finer[size] for size in sizes})


def _of_sizes(case: Case, sizes: Mapping[str, float]) -> Case:
    return case.model_copy(update={"discretisation": case.discretisation.model_copy(update=sizes)})


def _missed(best: Refinement, tolerance: float) -> SolveError:
    """The error of a tolerance that is not reached, that of the case, or less where a run needs it."""
    used, mesh, error = best.case.discretisation, best.case.domain.mesh, apart(best.error, tolerance)
    below = best.case.lubrication.below
    here = f"discretisation.tolerance = {used.tolerance!r}: the estimated error"
    if tolerance != used.tolerance:
        error += f", not to the {tolerance!r} that the steps to come need"
    if mesh is not None:
        remedy = f"on the mesh of domain.mesh = {mesh}, which is not refined; raise it, or give a finer mesh"
        return SolveError(f"{here} is {error} {remedy}")
    limit = "a finer mesh does not lower it enough"
    if best.dofs > MOST_UNKNOWNS:
        limit = f"{best.dofs} unknowns are the most that is tried"
    elif not _has_room(best, finer := _finer(best.case, SIZES)):
        need = size(_bytes_of(best, finer))
        limit = f"a finer mesh needs some {need} of memory, this machine has {size(memory())}"
    sizes = ", ".join(f"{name} = {getattr(used, name):.4g}" for name in SIZES)
    higher = used.degree < HIGHEST_DEGREE[best.case.dimension]
    remedy = "raise it" + (f", or degree above {used.degree}" if higher else "")
    remedy += "" if below is None else f", or lower lubrication.below = {below!r}: a part is of its laws"
    return SolveError(f"{here} came down to {error}, with {sizes}, and {limit}; {remedy}")


class RefinedModel:
    """`StokesModel` of a case with a tolerance, with the sizes that the run has needed so far.

    They never get coarser again.
    """

    tolerance_key: ClassVar[str] = "discretisation.tolerance"

    def __init__(self, case: Case) -> None:
        self.remedy = f", or discretisation.degree (at most {HIGHEST_DEGREE[case.dimension]})"
        self.resolved = StokesModel(case)
        self._known: tuple[Instant, StepErrors] | None = None

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> StokesSolution:
        """As `StokesModel`."""
        return self.resolved(q, t, inertia)

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:
        """The estimated errors of an instant; estimated once."""
        if self._known is None or self._known[0] is not instant:
            self._known = instant, self.resolved.errors(q, t, instant)
        return self._known[1]

    def refine(self, q: Configuration, t: float, instant: Instant) -> None:
        """Take finer sizes from now on, of an error at q and t below MARGIN of the tolerance, as `refine`."""
        case = self.resolved.case
        tolerance = MARGIN * (case.discretisation.tolerance or 1.0)
        self.resolved = StokesModel(refined(case, q, t, motion_of(case, q, t, instant), tolerance).case)

    def state(self) -> dict[str, NDArray[Any]]:
        """The sizes in use, and what `StokesModel` keeps."""
        used = self.resolved.case.discretisation
        return {**self.resolved.state(), "sizes": np.array([float(getattr(used, size)) for size in SIZES])}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `state` gave."""
        case = self.resolved.case
        kinds = (type(getattr(case.discretisation, size)) for size in SIZES)
        values = (kind(value) for kind, value in zip(kinds, state["sizes"], strict=True))
        self.resolved = StokesModel(_of_sizes(case, dict(zip(SIZES, values, strict=True))))
        self.resolved.restore(state)
