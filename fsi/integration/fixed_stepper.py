"""Steps of given length, for schemes that reject none."""

from __future__ import annotations

from dataclasses import dataclass

from fsi.bodies.configuration import Configuration
from fsi.integration.schedule import Schedule
from fsi.integration.state import Model, Scheme, State, Step
from fsi.meshes.geometry.containers import Container


@dataclass(frozen=True, slots=True)
class FixedStepper:
    """Advances the bodies by steps of length h, longer or shorter to land on the times that matter."""

    model: Model
    scheme: Scheme
    container: Container
    schedule: Schedule
    h: float

    def start(self, q: Configuration, first_step: float | None = None) -> Step:  # noqa: ARG002
        """The step of length 0 that begins a run; the length of all others is given."""
        instant = self.scheme.start(self.model, q)
        return Step(State(0.0, 0, q, instant.U, self.h), instant, 0.0, 0)

    def advance(self, state: State) -> Step:
        """One step. Raises SolveError."""
        t_end = self.schedule.landing(state.t, self.h)
        trial = self.scheme.step(self.model, state, t_end)
        new = State(t_end, state.step + 1, trial.q, trial.instant.U, self.h)
        return Step(new, trial.instant, t_end - state.t, 0)
