"""The decoupled distance scheme of the slides, and its variant with an implicit Euler step of each distance.

The model (`fsi.reduced.distance_model`) remembers the gaps and makes the steps; here they have their names.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol, cast

import numpy as np

from fsi.bodies.configuration import Array, Configuration
from fsi.integration.schemes.registry import Beginning, register_scheme
from fsi.integration.state import Instant, Model, State, Trial


class MarchingModel(Model, Protocol):
    """A model that makes its steps itself, as the distances of its pairs are part of its state."""

    def begin(self, q: Configuration, U: Array) -> Instant:
        """The instant at time 0 with the velocities (N, M); the memory begins."""

    def march(self, state: State, t_end: float) -> tuple[Configuration, Instant]:
        """One step from `state` to `t_end`: where it ends, and the instant there."""


@register_scheme("distance", "all", fixed=True, models=("reduced",))
@register_scheme("backward-euler", "all", fixed=True, models=("reduced",))
@dataclass(frozen=True, slots=True)
class DistanceScheme:
    """Steps of given length, of order 1: nothing is rejected, since stored gaps stay positive."""

    beginning: Beginning
    error_order: ClassVar[int] = 2

    def start(self, model: Model, q: Configuration) -> Instant:
        """The instant at time 0."""
        return cast(MarchingModel, model).begin(q, self.beginning.U)

    def step(self, model: Model, state: State, t_end: float) -> Trial:
        """One step, without an estimate of its error."""
        q, instant = cast(MarchingModel, model).march(state, t_end)
        return Trial(q, instant, np.zeros_like(instant.U))
