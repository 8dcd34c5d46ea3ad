"""Motion of the bodies in time, landing on the times that matter.

`Stepper` chooses its steps by the error and by the gaps, `RefiningStepper` makes steps again with a finer
model until their estimated error is below `discretisation.tolerance`.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia
from fsi.bodies.gaps import nearest_gaps
from fsi.errors import SolveError, apart
from fsi.integration.displacements import Displacements
from fsi.integration.errors import StepErrors
from fsi.integration.gap_limiter import (
    Approach,
    GapRefusedError,
    greatest_approach,
    limited_step,
    lost_in_rounding,
)
from fsi.integration.state import Advance, Instant, Model, Schedule, Scheme, State, Step, velocities
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.lattice import unit_shear

# Step controller of Hairer, Norsett & Wanner, Solving ODEs I, section II.4.
SAFETY = 0.9
LARGEST_GROWTH = 2.0
LEAST_CUT, DEEPEST_CUT = 0.5, 0.1  # of a step that is tried again


@dataclass(frozen=True, slots=True)
class _Guarded:
    """A model that refuses configurations in which a gap has lost more than `gap_loss` since `start`."""

    model: Model
    start: Configuration
    begin: float
    container: Container
    gap_loss: float

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> Instant:
        displacement, duration = self.start.way_to(q), t - self.begin
        container = self.container.sheared((q.strain - self.start.strain) / duration)
        approach = greatest_approach(self.start, container, displacement, self.gap_loss, duration)
        if not approach.loss <= self.gap_loss:  # also where it is not a number
            raise GapRefusedError(approach)
        return self.model(q, t, inertia)

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors | None:
        return self.model.errors(q, t, instant)

    def state(self) -> dict[str, NDArray[Any]]:
        return self.model.state()

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        self.model.restore(state)


@dataclass(frozen=True, slots=True)
class Stepper:
    """Advances the bodies with a model and a scheme.

    names: of the bodies; tolerance: error of a step's displacement relative to the smaller of the
    body's radius and its smallest gap, which is what lubrication feels, and of its angle in radians;
    gap_loss: largest fraction that a gap may lose in a step, in (0, 1); smallest_step: a time; first_step:
    the first to try, one by the tolerance if None.
    """

    model: Model
    scheme: Scheme
    container: Container
    names: Sequence[str]
    schedule: Schedule
    tolerance: float
    gap_loss: float
    smallest_step: float
    first_step: float | None = None

    def start(self, q: Configuration) -> Step:
        """The step of length 0 that begins a run."""
        instant, U = self.scheme.start(self.model, q)
        h = self._first_step(q, U) if self.first_step is None else self.first_step
        return Step(State(0.0, 0, q, U, h), instant, 0.0, 0)

    def advance(self, state: State) -> Step:
        """One accepted step; a rejected one is cut.

        Raises SolveError: it would be below `smallest_step`, or its error is no number.
        """
        h, rejected, container = state.h, 0, self.container.at(state.t, state.q.strain)
        while True:
            h, approach = limited_step(state.q, container, state.U, h, self.gap_loss)
            if not h >= self.smallest_step:
                raise self._blocked(state, approach)
            t_end = self.schedule.landing(state.t, h)
            model = _Guarded(self.model, state.q, state.t, container, self.gap_loss)
            try:
                trial = self.scheme.step(model, state, t_end)
                if np.isnan(trial.error).any():
                    raise SolveError(
                        f"time.scheme: its error of the step to t = {t_end:.9g} is not a number; correct the "
                        "scheme, or give another one"
                    )
                error = self._size_of_error(state, trial.error) / self.tolerance
                factor = self._factor(error)
            except GapRefusedError as refusal:
                approach, error, factor = refusal.approach, math.inf, LEAST_CUT
            if error <= 1.0:
                break
            rejected += 1
            h = max(DEEPEST_CUT, min(factor, LEAST_CUT)) * (t_end - state.t)
            if h < self.smallest_step:
                raise self._blocked(state, approach)
        used = t_end - state.t
        q, instant, past = trial.q, trial.instant, trial.past
        lost = lost_in_rounding((state.q, container), (q, self.container.at(t_end, q.strain)))
        if lost is not None:
            raise SolveError(
                f"at t = {t_end:.9g} the gap between {self._sides(lost)} is {lost.gap:.3g}, which is lost in "
                "the rounding of their places; end the run before, by time.end or time.contact_gap"
            )
        if past is not None and self.schedule.is_kink(t_end):
            past = past.forgotten()
        following = self._next_step(h, used, factor, rejected)
        new = State(t_end, state.step + 1, q, velocities(instant), following, past)
        return Step(new, instant, used, rejected, trial.error)

    def _size_of_error(self, state: State, error: Array) -> float:
        """Of a step, as an error that its displacement (N, M) has; the mean flow carries images exactly."""
        q, container = state.q, self.container.at(state.t, state.q.strain)
        strain = q.strain_of(error) * unit_shear(q.dimension)
        return Displacements(q, container, error, strain).size()

    def _first_step(self, q: Configuration, U: Array) -> float:
        """The step whose error is the tolerance if it is that power of the displacement, both relative."""
        container = self.container.sheared(q.strain_of(U))
        speed = Displacements(q, container, U, container.mean_gradient).size()
        tolerated = self.tolerance ** (1.0 / self.scheme.error_order)
        return min(self.schedule.end, tolerated / speed) if speed > 0.0 else self.schedule.end

    def _factor(self, error: float) -> float:
        """By which a step of that error could be longer, its error a little below what is tolerated."""
        return SAFETY * error ** (-1.0 / self.scheme.error_order) if error > 0.0 else LARGEST_GROWTH

    def _next_step(self, h: float, used: float, factor: float, rejected: int) -> float:
        """The next step to try, after one of length `used` that was proposed as h."""
        growth = min(factor, 1.0 if rejected else LARGEST_GROWTH)
        # A step cut short to land on a time says nothing against the longer one that was proposed.
        return max(used * growth, h) if growth == LARGEST_GROWTH else used * growth

    def _blocked(self, state: State, approach: Approach) -> SolveError:
        return SolveError(
            f"time.smallest_step = {self.smallest_step:g}: a shorter step is needed at t = {state.t:.9g}, "
            f"where the gap between {self._sides(approach)} is {approach.gap:.3g}; lower it in a new "
            "run, or end the run before"
        )

    def _sides(self, approach: Approach) -> str:
        """Between what it is."""
        sides = [*self.names, *(f"wall {name}" for name in self.container.walls)]
        i, j = approach.between
        return f"{sides[i]} and {'its own image' if i == j else sides[j]}"


# A step that is made again on finer meshes ends elsewhere, by about the error that it had.
TRIES = 4


@runtime_checkable
class Refinable(Model, Protocol):
    """A model that can be made finer.

    Attributes:
        tolerance_key: the key of the case to which it is refined.
        remedy: what else helps where that is not reached, after "raise it".
    """

    tolerance_key: ClassVar[str]
    remedy: str

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:
        """The estimated errors of an instant that this model gave."""

    def refine(self, q: Configuration, t: float, instant: Instant) -> None:
        """Be so fine from now on that the error of this instant is well below the tolerance."""


@dataclass(frozen=True, slots=True)
class RefiningStepper:
    """A stepper that makes a step again, with a finer model, when the error at its end is too large.

    stepper: makes the steps, with `refinable` as its model; tolerance: of the largest error over the largest
    result.
    """

    stepper: Advance
    refinable: Refinable
    tolerance: float

    @property
    def model(self) -> Model:
        """The model."""
        return self.refinable

    @property
    def container(self) -> Container:
        """What encloses the fluid."""
        return self.stepper.container

    @property
    def schedule(self) -> Schedule:
        """The times to land on."""
        return self.stepper.schedule

    def start(self, q: Configuration) -> Step:
        """The step of length 0 that begins a run."""
        return self._accurate(partial(self.stepper.start, q))

    def advance(self, state: State) -> Step:
        """One accepted step, its error below the tolerance. Raises SolveError: that is out of reach."""
        return self._accurate(partial(self.stepper.advance, state))

    def _accurate(self, make: Callable[[], Step]) -> Step:
        for _ in range(TRIES):
            step = make()
            q, t = step.state.q, step.state.t
            error = max(self.refinable.errors(q, t, step.instant).relative.values(), default=0.0)
            if error <= self.tolerance:
                return step
            self.refinable.refine(q, t, step.instant)
        gap, size = nearest_gaps(q, self.container.at(t, q.strain)).smallest(), apart(error, self.tolerance)
        raise SolveError(
            f"{self.refinable.tolerance_key} = {self.tolerance!r}: missed at t = {t:.9g}, where the error is "
            f"{size} with the finest that was tried, and the smallest gap {gap:.3g}; raise it"
            f"{self.refinable.remedy}, or end the run before"
        )
