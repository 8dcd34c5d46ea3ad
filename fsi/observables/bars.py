"""Error bars of an instant from the same one computed otherwise: with another degree, or other modes.

The difference times a factor, which the model knows, bounds the error; it is at least what rounding leaves,
and what chance may hide in one result of many. Where errors have several causes the bounds of each add up.
"""

from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration, Motion
from fsi.case.case import Case
from fsi.integration.errors import ErrorEstimate, StepErrors, StressErrors
from fsi.integration.state import Results
from fsi.observables.bulk_stress import BulkStress
from fsi.observables.resistance import KNOWN_TO
from fsi.observables.truncation import flow_scales, relative_change

# Of the largest result: what the factorisation leaves at gaps of 1e-5 radii, where it is worst.
ROUNDING = 1e-11


@dataclass(frozen=True, slots=True)
class DrivenBodies:
    """The bodies of a case at q and t, and what holds and drives them."""

    case: Case
    q: Configuration
    t: float
    motion: Motion


def motion_of(case: Case, q: Configuration, t: float, instant: Results) -> Motion:
    """What held and drove the bodies at an instant.

    Bodies with mass have the velocity that their history gave them: the error is that of the force at this
    velocity.
    """
    motion, masses = case.motion_at(q, t), case.masses()
    if masses is None:
        return motion
    held = motion.held | (masses > 0.0)
    return Motion(held, np.where(held, instant.U, 0.0), np.where(held, 0.0, motion.F))


@dataclass(frozen=True, slots=True)
class Compared:
    """The same instant computed otherwise.

    Attributes:
        results: of the same bodies.
        factor: what makes the difference a bound of the error.
        chance: the part of the largest difference to which each is known: by chance some cancel.
    """

    results: Results
    factor: float
    chance: float = KNOWN_TO


def step_errors(bodies: DrivenBodies, results: Results, *others: Compared) -> StepErrors:
    """Estimated errors of results from one or more others, the first with all that these have."""
    case, q, motion = bodies.case, bodies.q, bodies.motion
    other, factor, arms = others[0].results, others[0].factor, q.arms

    def bound(values: Array, compared: list[Array], arm: Array, computed: NDArray[np.bool_]) -> Array:
        counts, error = computed & case.modes, np.zeros_like(arm)
        for each, reference in zip(others, compared, strict=True):
            difference = each.factor * np.abs(values - reference)
            largest = np.where(counts, difference / arm, 0.0).max(initial=0.0)
            error += np.maximum(difference, arm * each.chance * largest)
        rounding = ROUNDING * np.abs(values / arm).max(initial=0.0)
        return np.where(counts, np.maximum(error, arm * rounding), 0.0)

    U = bound(results.U, [each.results.U for each in others], 1.0 / arms, ~motion.held)
    F = bound(results.F, [each.results.F for each in others], arms, motion.held)
    lost = getattr(results, "dissipation", nan)
    off = [each.factor * abs(lost - getattr(each.results, "dissipation", nan)) for each in others]
    dissipation = max(sum(off), ROUNDING * lost)  # nan of an infinite one
    viscosity = _of_viscosity(results, other, factor)
    errors = ErrorEstimate(U, F, dissipation, viscosity, _of_stress(results, other, factor))
    relative = relative_change(results, errors, motion.held, q.arms, flow_scales(case, bodies.t))
    mu = getattr(results, "apparent_viscosity", None)
    if mu is not None and viscosity is not None:
        relative["viscosity"] = viscosity / abs(mu)
    away = [each.factor * np.subtract(_motion(each.results), _motion(results)) for each in others]
    return StepErrors(errors, relative, np.sum(away, axis=0))


def _motion(results: Results) -> tuple[Array, Array]:
    return results.U, results.F


def _of_viscosity(results: Results, other: Results, factor: float) -> float | None:
    """The same for the apparent viscosity of a periodic flow, not a number at instants without one."""
    if getattr(other, "bulk", None) is None:
        return None
    mu, mu_other = (getattr(each, "apparent_viscosity", None) for each in (results, other))
    return nan if mu is None or mu_other is None else max(factor * abs(mu - mu_other), ROUNDING * abs(mu))


def _of_stress(results: Results, other: Results, factor: float) -> StressErrors | None:
    """The same for the stress of a periodic flow."""
    bulk: BulkStress | None = getattr(results, "bulk", None)
    of_other: BulkStress | None = getattr(other, "bulk", None)
    return None if bulk is None or of_other is None else bulk.errors(of_other, factor, ROUNDING)
