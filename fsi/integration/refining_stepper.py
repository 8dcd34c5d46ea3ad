"""Steps whose estimated error is below `discretisation.tolerance`: others are made again on finer meshes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Protocol, runtime_checkable

from fsi.bodies.configuration import Configuration
from fsi.errors import SolveError
from fsi.integration.schedule import Schedule
from fsi.integration.state import Advance, Instant, Model, State, Step
from fsi.integration.step_errors import StepErrors
from fsi.meshes.geometry.containers import Container

# A step that is made again on finer meshes ends elsewhere, by about the error that it had.
TRIES = 4


@runtime_checkable
class Refinable(Model, Protocol):
    """A model whose meshes can be made finer."""

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:
        """The estimated errors of an instant that this model gave."""

    def refine(self, q: Configuration, t: float, instant: Instant) -> None:
        """Use meshes from now on that lower the error of this instant well below the tolerance."""


@dataclass(frozen=True, slots=True)
class RefiningStepper:
    """A stepper that makes a step again, with a finer mesh, when the error at its end is too large.

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

    def start(self, q: Configuration, first_step: float | None = None) -> Step:
        """The step of length 0 that begins a run."""
        return self._accurate(partial(self.stepper.start, q, first_step))

    def advance(self, state: State) -> Step:
        """One accepted step whose error is below the tolerance.

        Raises:
            SolveError: as the stepper; or the tolerance is out of reach.
        """
        return self._accurate(partial(self.stepper.advance, state))

    def _accurate(self, make: Callable[[], Step]) -> Step:
        for _ in range(TRIES):
            step = make()
            q, t = step.state.q, step.state.t
            error = max(self.refinable.errors(q, t, step.instant).relative.values(), default=0.0)
            if error <= self.tolerance:
                return step
            self.refinable.refine(q, t, step.instant)
        raise SolveError(
            f"discretisation.tolerance = {self.tolerance:g}: missed at t = {t:.9g}, where the error is "
            f"{error:.1e} on the finest mesh that was tried; raise it, or discretisation.degree"
        )
