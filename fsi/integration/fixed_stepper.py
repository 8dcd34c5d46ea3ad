"""Steps of given length for the distance schemes: nothing is rejected, since stored gaps stay positive."""

from __future__ import annotations

from dataclasses import dataclass

from fsi.bodies.configuration import Configuration
from fsi.integration.schedule import Schedule
from fsi.integration.stepper import State, Step
from fsi.meshes.geometry.containers import Container
from fsi.reduced.distance_model import DistanceModel


@dataclass(frozen=True, slots=True)
class FixedStepper:
    """Advances the bodies by steps of length h, longer or shorter to land on the times that matter."""

    model: DistanceModel
    container: Container
    schedule: Schedule
    h: float

    def start(self, q: Configuration, first_step: float | None = None) -> Step:  # noqa: ARG002
        """The step of length 0 that begins a run; the length of all others is given."""
        instant = self.model.begin(q)
        return Step(State(0.0, 0, q, instant.U, self.h), instant, 0.0, 0)

    def advance(self, state: State) -> Step:
        """One step. Raises SolveError."""
        t_end = self.schedule.landing(state.t, self.h)
        q, instant = self.model.march(state, t_end)
        return Step(State(t_end, state.step + 1, q, instant.U, self.h), instant, t_end - state.t, 0)
