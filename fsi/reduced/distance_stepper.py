"""The steps of the distance scheme, which its model makes itself: pairs remember their gaps."""

from dataclasses import dataclass

from fsi.bodies.configuration import Configuration
from fsi.integration.state import Schedule, State, Step
from fsi.meshes.geometry.container import Container
from fsi.reduced.distance_model import DistanceModel


@dataclass(frozen=True, slots=True)
class DistanceStepper:
    """Advances the bodies by steps of length h, longer or shorter to land on the times that matter.

    They are of order 1; nothing is rejected, since stored gaps stay positive, and no error is estimated.
    """

    model: DistanceModel
    container: Container
    schedule: Schedule
    h: float

    def start(self, q: Configuration) -> Step:
        """The step of length 0 that begins a run. Raises SolveError."""
        instant = self.model.begin(q)
        return Step(State(0.0, 0, q, instant.U, self.h), instant, 0.0, 0)

    def advance(self, state: State) -> Step:
        """One step. Raises SolveError."""
        t_end = self.schedule.landing(state.t, self.h)
        q, instant = self.model.march(state, t_end)
        return Step(State(t_end, state.step + 1, q, instant.U, self.h), instant, t_end - state.t, 0)
