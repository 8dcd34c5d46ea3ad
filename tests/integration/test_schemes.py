from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from fsi.bodies.configuration import Array, Configuration, Inertia
from fsi.integration.schemes import AscherRuuthSpiteri, Beginning, BogackiShampine
from fsi.integration.state import Instant, Model, Scheme, State
from tests.exact_model import DiscsBesidePlane, ExactInstant, settling_case


class Field:
    """A model whose velocities are a given function of (q, t)."""

    def __init__(self, velocity: Callable[[Configuration, float], Array]) -> None:
        self.velocity = velocity

    def __call__(
        self,
        q: Configuration,
        t: float,
        inertia: Inertia | None = None,  # noqa: ARG002
    ) -> ExactInstant:
        U = self.velocity(q, t)
        return ExactInstant(U, U)

    def errors(self, q: Configuration, t: float, instant: Instant) -> None:
        pass

    def state(self) -> dict[str, NDArray[Any]]:
        return {}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        pass


def fixed_steps(scheme: Scheme, model: Model, q: Configuration, end: float, number: int) -> State:
    """The state after equal steps without control."""
    state = State(0.0, 0, q, scheme.start(model, q).U, end / number)
    for k in range(1, number + 1):
        trial = scheme.step(model, state, end * k / number)
        state = State(end * k / number, k, trial.q, trial.instant.U, state.h)
    return state


def slope(errors: list[float]) -> float:
    """Order between the last two of halved steps."""
    return math.log2(errors[-2] / errors[-1])


def disc_at(x: float, y: float) -> Configuration:
    return Configuration(np.array([[x, y]]), np.zeros(1), np.ones(1))


def spiral(q: Configuration, t: float) -> Array:
    """`z' = (i - 1/2) z + e^{it}` for z = x + i y, `angle' = cos t`."""
    z = q.centres[:, 0] + 1j * q.centres[:, 1]
    w = (1j - 0.5) * z + np.exp(1j * t)
    return np.column_stack([w.real, w.imag, np.cos(t) * np.ones(len(q))])


def test_bogacki_shampine_has_order_three_and_its_estimate_too() -> None:
    errors, estimates = [], []
    for number in (20, 40, 80):
        q = fixed_steps(BogackiShampine(), Field(spiral), disc_at(1.0, 0.0), 2.0, number).q
        # z = 2 e^{it} - e^{(i - 1/2) t} solves it with z(0) = 1.
        z = 2 * np.exp(2j) - np.exp((1j - 0.5) * 2.0)
        errors.append(float(np.hypot(*(q.centres[0] - (z.real, z.imag)))))
        start = State(0.0, 0, disc_at(1.0, 0.0), spiral(disc_at(1.0, 0.0), 0.0), 0.0)
        estimates.append(float(abs(BogackiShampine().step(Field(spiral), start, 2.0 / number).error).max()))
        assert q.angles[0] == pytest.approx(math.sin(2.0), rel=(2.0 / number) ** 3)
    assert slope(errors) == pytest.approx(3.0, abs=0.1)
    assert slope(estimates) == pytest.approx(3.0, abs=0.1)


def test_inertia_has_order_two_with_the_resistance_of_the_film() -> None:
    """The force depends on time too, which tells whether each stage takes it at its own."""
    force = {"times": [0.0, 2.0], "values": [-5.0, -50.0]}
    case = settling_case(0.5, body={"force": [0.0, force], "mass": 10.0, "moment_of_inertia": 1.0})
    masses = np.array([[10.0, 10.0, 1.0]])
    scheme = AscherRuuthSpiteri(Beginning(masses, np.zeros((1, 3)), rest=1e-12))
    model = DiscsBesidePlane(case)

    def newton(t: float, y: Array) -> list[float]:
        R = model.resistance(disc_at(0.0, y[0]))[0, 1]
        return [y[1], (case.motion(t).F[0, 1] - R * y[1]) / 10.0]

    exact = solve_ivp(newton, (0.0, 0.5), [2.0, 0.0], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    positions, velocities = [], []
    for number in (40, 80, 160):
        end = fixed_steps(scheme, model, case.configuration(), 0.5, number)
        positions.append(abs(end.q.centres[0, 1] - exact[0]))
        velocities.append(abs(end.U[0, 1] - exact[1]))
    assert slope(positions) == pytest.approx(2.0, abs=0.1)
    assert slope(velocities) == pytest.approx(2.0, abs=0.1)
