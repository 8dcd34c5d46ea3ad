"""How far the bodies of a run have strayed from the exact motion: the bars of positions, gaps and times.

The velocities of a run miss by delta, that of the elements, and each step ends at a distance eps of its own
from where its velocities lead. To first order the distance e of the exact motion from that of the run obeys

    e' = J e + delta,   J = dU/dq,        e -> e + eps at the end of a step,

for each of the two causes, stepped by the trapezoidal rule with a predictor; J e is a difference of
velocities, for one solve more of each. So errors decay where bodies approach a wall and grow where they part,
and what moves together strays together. delta has the sign of the estimate. eps, that of the member of lower
order, takes in each component the sign that lengthens e. As the two causes may have any signs to each other,
the bar of a position is the sum of both |e|.

A gap s strays by |grad s . e|, and the time at which the run has it by that over the rate s'.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import PLACES, Array, Configuration
from fsi.bodies.gaps import nearest_gaps
from fsi.integration.state import Model, Step
from fsi.meshes.geometry.container import Container

# Of the smallest gap or radius, by which velocities are differenced: far above what a new mesh changes.
SMALL = 0.02
# At the loosest tolerance, 1e-2, the error of a step of a settling disc was 1.3 times the estimate.
STEP_SAFETY = 2.0
SMALLER = 1e-3  # the same for gaps, which are exact


def _none() -> Array:
    return np.zeros((2, 0, 0))


@dataclass(slots=True)
class Strayed:
    """The distances e by their cause, elements and steps, and what the next step needs; zero at the start.

    Attributes:
        e: of the exact motion from that of the run, (2, N, M).
        rate: J e, (2, N, M).
        delta: of the exact velocities from those of the run, and zero for the steps, (2, N, M).
    """

    e: Array = field(default_factory=_none)
    rate: Array = field(default_factory=_none)
    delta: Array = field(default_factory=_none)

    def follow(self, step: Step, delta: Array, model: Model, container: Container) -> None:
        """Take a step, at whose end velocities miss by delta (N, M); two solves, collective."""
        h, delta = step.h, np.stack([delta, np.zeros_like(delta)])
        if h == 0.0:
            self.e, self.rate, self.delta = np.zeros_like(delta), np.zeros_like(delta), delta
            return
        missed = 0.5 * h * (self.delta + delta)
        if step.error is not None:
            eps = STEP_SAFETY * step.error
            missed[1] = np.copysign(eps, np.where(self.e[1] == 0.0, eps, self.e[1]))
        rate = np.stack([_carried(step, e, model, container) for e in self.e + h * self.rate + missed])
        self.e = self.e + 0.5 * h * (self.rate + rate) + missed
        self.rate, self.delta = rate, delta

    def gap_error(self, q: Configuration, container: Container) -> float:
        """How far the smallest gap has strayed."""
        return sum(_gap_change(q, e, container) for e in self.e)

    def body_columns(self, q: Configuration) -> Mapping[str, Array]:
        """Of bodies.csv: the errors of positions and angles, absolute, (N,) each."""
        errors = np.abs(self.e).sum(axis=0).T
        return {f"err_{name}": error for name, error in zip(PLACES[q.dimension], errors, strict=True)}

    def memory(self) -> dict[str, NDArray[Any]]:
        """What must be restored, by name."""
        return {"strayed": np.stack([self.e, self.rate, self.delta])}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take back what `memory` gave."""
        self.e, self.rate, self.delta = memory["strayed"]


def _carried(step: Step, e: Array, model: Model, container: Container) -> Array:
    """J e at the end of a step, (N, M)."""
    q, t = step.state.q, step.state.t
    scale = SMALL * _scale(q, e, container.at(t))
    if scale == 0.0:
        return np.zeros_like(e)
    U: Array = model(q.moved(scale * e), t).U
    return np.asarray((U - step.state.U) / scale)


def _gap_change(q: Configuration, e: Array, container: Container) -> float:
    """|grad s . e| of the smallest gap s."""
    scale = SMALLER * _scale(q, e, container)
    if scale == 0.0:
        return 0.0
    gap = nearest_gaps(q, container).smallest()
    return abs(nearest_gaps(q.moved(scale * e), container).smallest() - gap) / scale


def _scale(q: Configuration, e: Array, container: Container) -> float:
    """The smallest gap or radius over the length of e; zero if that is."""
    length = float(np.abs(q.arms * e).max(initial=0.0))
    smallest = min(nearest_gaps(q, container).smallest(), float(q.radii.min(initial=np.inf)))
    return smallest / length if length > 0.0 else 0.0
