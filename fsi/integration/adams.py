"""The scheme of one solve a step: it remembers velocities instead of asking for more of them."""

from dataclasses import dataclass
from itertools import combinations
from typing import ClassVar

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import MODES, Configuration
from fsi.integration.state import Instant, Model, Past, State, Trial, velocities

# How many velocities the predictor takes, which is its order.
ORDER = 3


@dataclass(frozen=True, slots=True)
class Adams:
    """`q' = U(q, t)`: the predictor of Adams and Bashforth, corrected by that of Adams and Moulton (PEC).

    E. Hairer, S. P. Norsett & G. Wanner, Solving ODEs I, sections III.1 and III.5.

    With the last K velocities at times t_k <= t, and p_n the place at which that of step n was solved for,

        p_{n+1} = q_n + h sum_k b_k U_k,     U_{n+1} = U(p_{n+1}, t_{n+1}),     K <= 3
        q_{n+1} = q_n + h sum_k a_k U_k,     now with U_{n+1} too

    where the weights integrate what interpolates these velocities, whatever the steps were. In space turns
    do not commute: 1/2 int int_{s < t} omega(t) x omega(s) ds dt of what interpolates is added (Magnus 1954).
    The instant of a step is that at p_{n+1}, so that forces and fields are those there; the correction
    q_{n+1} - p_{n+1}, which is the error of p_{n+1}, goes into the next step and does not add up. It begins
    with K = 1, at the start and after each kink of the data, and takes one more at each step. A step misses
    h^(K+2), so that of equal steps the first leaves h^3, and all after the third add up to h^4: order 3 as a
    whole, 4 where a tolerance keeps first steps short. The correction is of order h^(K+1).
    """

    error_order: ClassVar[int] = ORDER + 1

    def start(self, model: Model, q: Configuration) -> tuple[Instant, Array]:
        """The instant at time 0, and its velocities."""
        instant = model(q, 0.0)
        return instant, velocities(instant)

    def step(self, model: Model, state: State, t_end: float) -> Trial:
        """One step; the error is the correction of where it ends, and what turns in space neglect."""
        past, h = _with_the_present(state), t_end - state.t
        x = (past.t - state.t) / h
        predicted = _displacement(h, x, past.U)
        q_end = state.q.moved(past.correction + predicted)
        instant = model(q_end, t_end)
        U = np.concatenate([velocities(instant)[None], past.U])
        corrected = _displacement(h, np.append(1.0, x), U)
        error = corrected - predicted + _neglected(state.q, h, np.append(1.0, x), U, corrected)
        return Trial(q_end, instant, error, Past(past.t, past.U, corrected - predicted))


def _with_the_present(state: State) -> Past:
    """The last velocities, with that at which a step begins."""
    if state.past is None:
        return Past(np.array([state.t]), state.U[None], np.zeros_like(state.U))
    t = np.append(state.t, state.past.t)[:ORDER]
    return Past(t, np.concatenate([state.U[None], state.past.U])[:ORDER], state.past.correction)


def _displacement(h: float, x: Array, U: Array) -> Array:
    """In the time h, (N, M), by what interpolates velocities U (K, N, M) at times x h."""
    displacement: Array = h * np.tensordot(_weights(x), U, 1)
    if U.shape[2] == len(MODES[3]):
        c = np.tensordot(np.linalg.inv(np.vander(x, increasing=True)), U[:, :, 3:], 1)
        for j, k in combinations(range(len(x)), 2):
            weight = 0.5 * h**2 * (1.0 / (k + 1) - 1.0 / (j + 1)) / (j + k + 2)
            displacement[:, 3:] += weight * np.cross(c[j], c[k])
    return displacement


def _neglected(q: Configuration, h: float, x: Array, U: Array, displacement: Array) -> Array:
    """What turns in space need beyond the two terms of a displacement s from q, (N, M); U[0] is at its end.

    The terms neglected are of order h^5, and their rate at the end is what s' there is not: of the two terms
    `omega + 1/2 omega x int omega dt`, of true displacements `q.rates(s, omega)`.
    """
    if U.shape[2] != len(MODES[3]):
        return np.zeros_like(displacement)
    rate = U[0].copy()
    rate[:, 3:] += 0.5 * h * np.cross(U[0, :, 3:], np.tensordot(_weights(x), U[:, :, 3:], 1))
    neglected: Array = h / 5 * (q.rates(displacement, U[0]) - rate)
    return neglected


def _weights(x: Array) -> Array:
    """Those that integrate polynomials from 0 to 1 exactly by their values at x (K,): sum w x^m = 1/(m+1)."""
    return np.linalg.solve(np.vander(x, increasing=True).T, 1.0 / np.arange(1, len(x) + 1))
