"""The resolved model's side of `fsi calibrate`: one resistance with its error."""

from __future__ import annotations

import time

from fsi.calibration.pair import Pair
from fsi.calibration.samples import Sample
from fsi.integration.step_errors import ErrorEstimate
from fsi.observables.truncation import halved
from fsi.stokes.adapt import solve_with_errors
from fsi.stokes.model import StokesModel


def resolved_sample(pair: Pair, gap: float, *, held_out: bool) -> Sample:
    """The resistance of the pair at a gap; collective.

    Raises:
        MeshError, SolveError: as `fsi.stokes.adapt.solve_with_errors`.
    """
    began = time.process_time()
    solved = solve_with_errors(pair.at(gap))
    kappa, error = pair.resistance(solved.solution, solved.errors)
    half, change = halved(solved.case), 0.0
    if half is not None:
        smaller = StokesModel(half)(half.configuration(), 0.0)
        none = ErrorEstimate(0.0 * smaller.U, 0.0 * smaller.F)
        change = abs(pair.resistance(smaller, none)[0] - kappa)
    defect = max(solved.solution.checks.values())
    seconds = time.process_time() - began
    return Sample(gap, held_out, kappa, error, change, solved.solution.dofs, defect, seconds)
