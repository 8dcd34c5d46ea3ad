"""The model of pores of a case: configuration and time in, velocities of the bodies out.

Every instant has its own pores and its own matrix, so that nothing need be remembered but, with
`pores.tolerance`, how many modes an edge has by now. All ranks compute the same.
"""

from collections.abc import Mapping
from time import process_time
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array, Configuration, Inertia
from fsi.case.case import Case
from fsi.errors import SolveError
from fsi.integration.errors import StepErrors
from fsi.integration.state import Instant
from fsi.observables.bars import Compared, DrivenBodies, motion_of, step_errors
from fsi.pores.bars import bar_factor, finer, reference_modes
from fsi.pores.instant import PoreInstant
from fsi.pores.solve import PoreLoading, solve_pores
from fsi.pores.surfaces import NoPoresError, surfaces_of
from fsi.pores.system import PoreSystem


class PoreModel:
    """Pores between the bodies of a case, made anew for any configuration."""

    tolerance_key: ClassVar[str] = "pores.tolerance"
    remedy: ClassVar[str] = ""

    def __init__(self, case: Case) -> None:
        """A model of the case, with its modes; nothing is computed yet."""
        self.case = case
        self.modes: int = case.pores.modes
        self._known: tuple[Instant, StepErrors] | None = None

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> PoreInstant:
        """The flow at q and t. Raises SolveError: no pores there, or a violated identity."""
        return self.driven(DrivenBodies(self.case, q, t, self.case.motion_at(q, t)), self.modes, inertia)

    def driven(self, bodies: DrivenBodies, modes: int, inertia: Inertia | None = None) -> PoreInstant:
        """The flow around bodies that are driven in another way, with so many modes; raises as a call."""
        began = process_time()
        system = make_system(bodies, modes)
        assembled = process_time()
        flow = solve_pores(system, loading_of(bodies, inertia))
        seconds = {"assemble": assembled - began, "solve": process_time() - assembled}
        instant = PoreInstant(bodies, flow, seconds)
        instant.require_sound()
        return instant

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:
        """The estimated errors of an instant of this model; estimated once, by one solve with other modes."""
        if self._known is None or self._known[0] is not instant:
            bodies = DrivenBodies(self.case, q, t, motion_of(self.case, q, t, instant))
            self._known = instant, self.errors_of(bodies, instant, self.modes)
        return self._known[1]

    def errors_of(self, bodies: DrivenBodies, instant: Instant, modes: int) -> StepErrors:
        """The estimated errors of an instant with so many modes."""
        other = self.driven(bodies, reference_modes(modes))
        return step_errors(bodies, instant, Compared(other, bar_factor(modes)))

    def refine(self, q: Configuration, t: float, instant: Instant) -> None:  # noqa: ARG002
        """Take the next number of modes from now on; with the most there are, nothing changes."""
        self.modes = finer(self.modes) or self.modes

    def state(self) -> dict[str, NDArray[Any]]:
        """The modes in use."""
        return {"modes": np.array(self.modes)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `state` gave."""
        self.modes = int(state["modes"])


def make_system(bodies: DrivenBodies, modes: int) -> PoreSystem:
    """Pores and their matrix. Raises SolveError: no pores there, with the names of bodies and walls."""
    case, container = bodies.case, bodies.case.container().at(bodies.t)
    try:
        return PoreSystem.make(surfaces_of(bodies.q, container), modes, case.fluid.viscosity)
    except NoPoresError as error:
        problem = error.between([*case.names, *(f"wall {name}" for name in container.walls)])
        raise SolveError(
            f'model = "pores" at t = {bodies.t:.9g}: no pores are found, as {problem}; give other places '
            '(bodies.position) or a narrower domain, or model = "resolved"'
        ) from None


def loading_of(bodies: DrivenBodies, inertia: Inertia | None = None) -> PoreLoading:
    """Everything that drives the bodies of a case."""
    case, container, walls = bodies.case, bodies.case.container(), bodies.case.wall_velocity(bodies.t)
    sliding = np.zeros((len(container.walls), 3))
    for k, name in enumerate(container.walls):
        sliding[k, :2] = walls[name].velocity
    gradient: Array = container.mean_gradient
    return PoreLoading(bodies.motion, sliding, gradient, *case.domain.mean_drive(), inertia)
