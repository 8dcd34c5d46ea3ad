"""With inertia: the implicit-explicit Runge-Kutta scheme of Ascher, Ruuth and Spiteri."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from fsi.bodies.configuration import Configuration, Inertia
from fsi.integration.schemes.registry import Beginning, register_scheme
from fsi.integration.state import Instant, Model, State, Trial

GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
DELTA = 1.0 - 1.0 / (2.0 * GAMMA)


@register_scheme("ascher-ruuth-spiteri", "some")
@dataclass(frozen=True, slots=True)
class AscherRuuthSpiteri:
    """`q' = U, m U' = F_ext(t) - F(q, U)`: the implicit-explicit Runge-Kutta scheme ARS(2,2,2).

    U. M. Ascher, S. J. Ruuth & R. J. Spiteri, Appl. Numer. Math. 25 (1997) 151, section 2.6.

    Positions take the explicit tableau, velocities the implicit one, in which the resistance is that
    of the stage's configuration: each stage is one linear solve. Order 2, L-stable, stiffly accurate:
    the last stage is the end of the step. Where m = 0 the velocity is the quasi-static one of its
    stage, so that m -> 0 is the motion without inertia.

    The first instant is that of an implicit Euler step, short against everything: bodies with mass have the
    velocity that they begin with, held modes their prescribed one, and modes without inertia their
    quasi-static one.

    Attributes:
        beginning: masses, shape (N, M), 0 for modes without inertia; the first velocities; that short time.
    """

    beginning: Beginning
    error_order: ClassVar[int] = 3

    def start(self, model: Model, q: Configuration) -> Instant:
        """The instant at time 0."""
        return model(q, 0.0, Inertia(self.beginning.masses / self.beginning.rest, self.beginning.U))

    def step(self, model: Model, state: State, t_end: float) -> Trial:
        """One step; the error is the difference of the displacement from the trapezoidal rule's."""
        t, q, U = state.t, state.q, state.U
        h = t_end - t
        D = self.beginning.masses / (GAMMA * h)
        U1 = model(q.moved(GAMMA * h * U), t + GAMMA * h, Inertia(D, U)).U
        # Each stage leaves h m^-1 (F_ext - F) = (U_i - U0_i) / gamma.
        U0 = U + (1.0 - GAMMA) / GAMMA * (U1 - U)
        displacement = h * (DELTA * U + (1.0 - DELTA) * U1)
        q_end = q.moved(displacement)
        instant = model(q_end, t_end, Inertia(D, U0))
        return Trial(q_end, instant, displacement - h / 2 * (U + instant.U))
