"""Error bars of an instant from the same one computed otherwise: with another degree, or other modes.

The difference times a factor, which the model knows, bounds the error; it is at least what rounding leaves,
of coordinates in narrow gaps above all, and what chance may hide in one result of many. Where errors have
several causes the bounds of each add up.
"""

import operator
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from math import inf
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Motion
from fsi.bodies.gaps import find_gaps
from fsi.bodies.surface_gap import narrowest_gap
from fsi.case.case import Case
from fsi.integration.errors import ErrorEstimate, StepErrors, StressErrors
from fsi.integration.state import Measured, Results
from fsi.observables.bulk_stress import BulkStress
from fsi.observables.resistance import KNOWN_TO
from fsi.observables.scales import ROUNDING, flow_scales, relative_change, rounded_dissipation

STEEPEST = 2.5  # power of a gap with which forces go, where gaps shut fluid in
LEVER = 16.0  # of 40 discs in a corner of a box, gaps from 1e-8 to 1e-6 radii, 14 at most


@dataclass(frozen=True, slots=True)
class DrivenBodies:
    """The bodies of a case at q and t, and what holds and drives them.

    Attributes:
        rounded: the part of a gap, at most, by which a model rounds it before it solves.
    """

    case: Case
    q: Configuration
    t: float
    motion: Motion
    rounded: float = 0.0


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


class FlowResults(Measured, Protocol):
    """Results of a flow."""

    @property
    def bulk(self) -> BulkStress | None:
        """The mean stress of a periodic flow, else None."""


@dataclass(frozen=True, slots=True)
class Compared:
    """The same instant computed otherwise.

    Attributes:
        results: of the same bodies.
        factor: what makes the difference a bound of the error.
        chance: the part of the largest difference to which each is known: by chance some cancel.
        chance_of_stress: the same of stresses and stresslets.
        chance_of_flow: the same of what the whole flow has, dissipation, fluxes and the speeds that stresses
            give, each as a part of itself.
        chance_of_free: the same as `chance` of velocities, if they differ.
    """

    results: FlowResults
    factor: float
    chance: float = KNOWN_TO
    chance_of_stress: float = KNOWN_TO
    chance_of_flow: float = 0.0
    chance_of_free: float | None = None


def step_errors(bodies: DrivenBodies, results: FlowResults, *others: Compared) -> StepErrors:
    """Estimated errors of results from one or more others, whose bounds add up."""
    case, motion, arms = bodies.case, bodies.motion, bodies.q.arms
    scales = flow_scales(case, bodies.t)
    speed, force = scales.largest(results, arms)
    units = np.stack([speed / arms, force * arms])
    computed = np.stack([~motion.held, motion.held]) & case.modes
    rounding = rounding_of(bodies)
    missed = [_largest(each, results, computed, units) for each in others]
    parts = zip(others, missed, strict=True)
    error = rounding * units + sum(_bound(each, results, part * units) for each, part in parts)
    error[0] += turned_by_rounding(bodies, results)
    U, F = np.where(computed, error, 0.0)
    by_chance = sum(each.chance_of_flow * part for each, part in zip(others, missed, strict=True))
    lost, known = results.dissipation, max(rounding, by_chance)
    off = [each.factor * abs(lost - each.results.dissipation) for each in others]
    dissipation = max(sum(off), known * lost)  # nan of an infinite one
    every = (_of_viscosity(results, each) for each in others)
    of_viscosity = [part for part in every if part is not None]
    viscosity = sum(of_viscosity) if of_viscosity else None
    of_stress = [part for each in others if (part := _of_stress(results, each)) is not None]
    stress = reduce(operator.add, of_stress) if of_stress else None
    if stress is not None and (bulk := results.bulk) is not None and bulk.in_gaps is not None:
        stress += bulk.error_in_gaps
    errors = ErrorEstimate(
        U, F, dissipation, viscosity, stress, *_of_driven(results, others, max(ROUNDING, by_chance))
    )
    relative = relative_change(results, errors, motion.held, arms, scales)
    mu = results.apparent_viscosity
    if mu is not None and viscosity is not None:
        relative["viscosity"] = viscosity / abs(mu)
    if not len(bodies.q) and rounded_dissipation(case, bodies.t) < lost < inf:  # nothing else tells of it
        relative["dissipation"] = dissipation / lost
    away = [each.factor * (_motion(each.results) - _motion(results)) for each in others]
    return StepErrors(errors, relative, np.sum(away, axis=0))


def rounding_of(bodies: DrivenBodies) -> float:
    """The part of a result that rounding makes.

    Coordinates x across a gap are rounded to eps |x|, so that it is known to a part eps |x| / gap, and to
    what the model rounds; what goes with a power of it is known to so many times this.
    """
    q, container = bodies.q, bodies.case.container().at(bodies.t, bodies.q.strain)
    if (gap := narrowest_gap(q, container)) is None:
        return ROUNDING
    farthest = float(abs(gap.opposite @ gap.normal) + q.radii[gap.sides[0]])
    return max(ROUNDING, STEEPEST * (float(np.finfo(float).eps) * farthest / gap.width + bodies.rounded))


def turned_by_rounding(bodies: DrivenBodies, results: Results) -> Array:
    """The velocities that rounding gives to bodies on which large loads balance, (N, M).

    A pressure with a load F acts through the centre of a disc, but for rounding: LEVER eps F a is left as a
    torque. What turns beside a gap q of the plane resists by 2 sqrt(2) pi mu a^2 (a/q)^(1/2).
    """
    q, case = bodies.q, bodies.case
    container = case.container().at(bodies.t, q.strain)
    load = LEVER * np.finfo(float).eps * np.abs(results.F / q.arms).max(axis=1)
    resistance = case.fluid.viscosity * (q.radii if case.spheres else np.ones(len(q)))
    if not case.spheres:
        narrow = np.minimum(find_gaps(q, container).smallest_of_each() / q.radii, 1.0)
        resistance *= np.sqrt(8.0 / narrow) * np.pi
    turned: Array = (load / resistance)[:, None] / q.arms
    return turned


def _motion(results: Results) -> Array:
    """U and F, (2, N, M)."""
    return np.stack([results.U, results.F])


def _largest(other: Compared, results: Results, computed: NDArray[np.bool_], units: Array) -> float:
    """The largest difference of U and F in their units, the largest velocity and load."""
    counts = computed & (units > 0.0)
    parts = np.divide(_difference(other, results), units, out=np.zeros_like(units), where=counts)
    return float(parts.max(initial=0.0))


def _bound(other: Compared, results: Results, largest: Array) -> Array:
    """What one other says of the errors of U and F, (2, N, M).

    Each is known to a part of the largest difference of both, (2, N, M): a velocity that is small by chance
    beside others and beside what loads miss has by chance a small one.
    """
    chances = (other.chance if other.chance_of_free is None else other.chance_of_free, other.chance)
    bound: Array = np.maximum(_difference(other, results), np.reshape(chances, (2, 1, 1)) * largest)
    return bound


def _difference(other: Compared, results: Results) -> Array:
    """The factor times that of U and F, (2, N, M)."""
    difference: Array = other.factor * np.abs(_motion(other.results) - _motion(results))
    return difference


def _of_viscosity(results: FlowResults, other: Compared) -> float | None:
    """The same for the apparent viscosity of a periodic flow, not a number at instants without one."""
    if (bulk := results.bulk) is None or (of_other := other.results.bulk) is None:
        return None
    return bulk.viscosity_error(of_other, other.factor, other.chance_of_stress, ROUNDING)


def _of_driven(
    results: Measured, others: Sequence[Compared], known: float
) -> tuple[Mapping[str, float], float | None, float | None, float | None]:
    """The sum for speeds of walls and the rate of shear by a stress, dp/dx by a flux, and a flux.

    known: the part of each to which it is known at best.
    """

    def bound(value: float, of_others: Iterable[float | None]) -> float:
        found = [other for other in of_others if other is not None]  # all of them, of the same flow
        off = (each.factor * abs(value - other) for each, other in zip(others, found, strict=True))
        return max(sum(off), known * abs(value))

    flows, speeds = [each.results for each in others], results.wall_speeds
    of_walls = {wall: bound(speeds[wall], (flow.wall_speeds[wall] for flow in flows)) for wall in speeds}
    rate, dp_dx, flux = results.shear_rate, results.dp_dx, results.flux
    of_cell = None if rate is None else bound(rate, (flow.shear_rate for flow in flows))
    of_gradient = None if dp_dx is None else bound(dp_dx, (flow.dp_dx for flow in flows))
    of_flux = None if flux is None else bound(flux, (flow.flux for flow in flows))
    return of_walls, of_cell, of_gradient, of_flux


def _of_stress(results: FlowResults, other: Compared) -> StressErrors | None:
    """The same for the stress of a periodic flow."""
    if (bulk := results.bulk) is None or (of_other := other.results.bulk) is None:
        return None
    return bulk.errors(of_other, other.factor, other.chance_of_stress, ROUNDING)
