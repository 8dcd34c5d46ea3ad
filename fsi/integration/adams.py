"""The scheme of one solve a step: it remembers velocities instead of asking for more of them."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fsi.bodies.configuration import Array, Configuration
from fsi.integration.state import Instant, Model, Past, State, Trial

# How many velocities the predictor takes, which is its order.
ORDER = 3


@dataclass(frozen=True, slots=True)
class Adams:
    """`q' = U(q, t)`: the predictor of Adams and Bashforth, corrected by that of Adams and Moulton (PEC).

    E. Hairer, S. P. Norsett & G. Wanner, Solving ODEs I, sections III.1 and III.5.

    With the last K velocities at times t_k <= t, and p_n the place at which that of step n was solved for,

        p_{n+1} = q_n + h sum_k b_k U_k,     U_{n+1} = U(p_{n+1}, t_{n+1}),     K <= 3
        q_{n+1} = q_n + h sum_k a_k U_k,     now with U_{n+1} too

    where the weights integrate what interpolates these velocities, whatever the steps were. The instant of a
    step is that at p_{n+1}, so that forces and fields belong to the place that is written; the correction
    q_{n+1} - p_{n+1}, which is the error of p_{n+1}, goes into the next step and does not add up. Order 4;
    the correction is of order h^(K+1). It begins with K = 1, at the start and after each kink of the data,
    and takes one more at each step.
    """

    error_order: ClassVar[int] = ORDER + 1

    def start(self, model: Model, q: Configuration) -> Instant:
        """The instant at time 0."""
        return model(q, 0.0)

    def step(self, model: Model, state: State, t_end: float) -> Trial:
        """One step; the error is the correction of where it ends."""
        past, h = _with_the_present(state), t_end - state.t
        x = (past.t - state.t) / h
        predicted = h * np.tensordot(_weights(x), past.U, 1)
        q_end = state.q.moved(past.correction + predicted)
        instant = model(q_end, t_end)
        U = np.concatenate([instant.U[None], past.U])
        correction = h * np.tensordot(_weights(np.append(1.0, x)), U, 1) - predicted
        return Trial(q_end, instant, correction, Past(past.t, past.U, correction))


def _with_the_present(state: State) -> Past:
    """The last velocities, with that at which a step begins."""
    if state.past is None:
        return Past(np.array([state.t]), state.U[None], np.zeros_like(state.U))
    t = np.append(state.t, state.past.t)[:ORDER]
    return Past(t, np.concatenate([state.U[None], state.past.U])[:ORDER], state.past.correction)


def _weights(x: Array) -> Array:
    """Those that integrate polynomials from 0 to 1 exactly by their values at x (K,): sum w x^m = 1/(m+1)."""
    return np.linalg.solve(np.vander(x, increasing=True).T, 1.0 / np.arange(1, len(x) + 1))
