"""The two one-step methods: without inertia an explicit pair, with inertia an implicit-explicit one."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fsi.bodies.configuration import Array, Configuration, Inertia
from fsi.integration.stepper import Instant, Model, State, Trial


@dataclass(frozen=True, slots=True)
class BogackiShampine:
    """`q' = U(q, t)`: the embedded Runge-Kutta pair 3(2).

    P. Bogacki & L. F. Shampine, A 3(2) pair of Runge-Kutta formulas, Appl. Math. Lett. 2 (1989) 321.

    The last stage lies at the end of the step: it is the instant recorded there and the first stage
    of the next step.
    """

    def start(self, model: Model, q: Configuration) -> Instant:
        """The instant at time 0."""
        return model(q, 0.0)

    def step(self, model: Model, state: State, t_end: float) -> Trial:
        """One step; the error is the difference of the two members of the pair."""
        t, q, U1 = state.t, state.q, state.U
        h = t_end - t
        U2 = model(q.moved(h / 2 * U1), t + h / 2).U
        U3 = model(q.moved(3 * h / 4 * U2), t + 3 * h / 4).U
        q_end = q.moved(h * (2 / 9 * U1 + 1 / 3 * U2 + 4 / 9 * U3))
        instant = model(q_end, t_end)
        return Trial(q_end, instant, h * (-5 / 72 * U1 + 1 / 12 * U2 + 1 / 9 * U3 - 1 / 8 * instant.U))


GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
DELTA = 1.0 - 1.0 / (2.0 * GAMMA)


@dataclass(frozen=True, slots=True)
class AscherRuuthSpiteri:
    """`q' = U, m U' = F_ext(t) - F(q, U)`: the implicit-explicit Runge-Kutta scheme ARS(2,2,2).

    U. M. Ascher, S. J. Ruuth & R. J. Spiteri, Appl. Numer. Math. 25 (1997) 151, section 2.6.

    Positions take the explicit tableau, velocities the implicit one, in which the resistance is that
    of the stage's configuration: each stage is one linear solve. Order 2, L-stable, stiffly accurate:
    the last stage is the end of the step. Where m = 0 the velocity is the quasi-static one of its
    stage, so that m -> 0 is the motion without inertia.

    masses: (m, m, I) of each body, shape (N, 3), 0 for modes without inertia.
    rest: duration, short against everything, of the implicit Euler step from rest that gives the
    first instant. So bodies start at rest, held modes at their prescribed velocity, and modes
    without inertia at their quasi-static one.
    """

    masses: Array
    rest: float

    def start(self, model: Model, q: Configuration) -> Instant:
        """The instant at time 0: free bodies with mass at rest."""
        return model(q, 0.0, Inertia(self.masses / self.rest, np.zeros_like(self.masses)))

    def step(self, model: Model, state: State, t_end: float) -> Trial:
        """One step; the error is the difference of the displacement from the trapezoidal rule's."""
        t, q, U = state.t, state.q, state.U
        h = t_end - t
        D = self.masses / (GAMMA * h)
        U1 = model(q.moved(GAMMA * h * U), t + GAMMA * h, Inertia(D, U)).U
        # Each stage leaves h m^-1 (F_ext - F) = (U_i - U0_i) / gamma.
        U0 = U + (1.0 - GAMMA) / GAMMA * (U1 - U)
        displacement = h * (DELTA * U + (1.0 - DELTA) * U1)
        q_end = q.moved(displacement)
        instant = model(q_end, t_end, Inertia(D, U0))
        return Trial(q_end, instant, displacement - h / 2 * (U + instant.U))
