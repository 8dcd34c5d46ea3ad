"""Without inertia: the explicit Runge-Kutta pair of Bogacki and Shampine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fsi.bodies.configuration import Configuration
from fsi.integration.schemes.registry import Beginning, register_scheme
from fsi.integration.state import Instant, Model, State, Trial


@dataclass(frozen=True, slots=True)
class BogackiShampine:
    """`q' = U(q, t)`: the embedded Runge-Kutta pair 3(2).

    P. Bogacki & L. F. Shampine, A 3(2) pair of Runge-Kutta formulas, Appl. Math. Lett. 2 (1989) 321.

    The last stage lies at the end of the step: it is the instant recorded there and the first stage
    of the next step. Order 3; the difference of its two members is of order h^3.
    """

    error_order: ClassVar[int] = 3

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


@register_scheme("bogacki-shampine")
def _make(_: Beginning) -> BogackiShampine:
    return BogackiShampine()
