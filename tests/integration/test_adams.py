"""The scheme of Adams: its order, and how it begins."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.integration.adams import Adams
from fsi.integration.schemes import SCHEMES
from fsi.integration.state import Past, State
from tests.integration.test_schemes import Field, slope, spiral


def unequal_steps(number: int) -> State:
    """The state of the spiral at t = 2 after long and short steps in turn, the past of it exact."""
    h = 2.0 / number
    before = -h * np.array([0.7, 2.0])
    U = np.array([spiral_exact(t)[1] for t in before])
    q, U_0 = spiral_exact(0.0)
    state = State(0.0, 0, q, U_0, h, Past(before, U, np.zeros_like(U_0)))
    for k in range(number):
        t_end = state.t + (1.3 if k % 2 else 0.7) * h
        trial = Adams().step(Field(spiral), state, t_end)
        state = State(t_end, k + 1, trial.q, trial.instant.U, h, trial.past)
    return state


def spiral_exact(t: float) -> tuple[Configuration, Array]:
    """z = 2 e^{it} - e^{(i - 1/2) t} solves it with z(0) = 1; where it is, and its velocity."""
    z = 2 * np.exp(1j * t) - np.exp((1j - 0.5) * t)
    q = Configuration(np.array([[z.real, z.imag]]), np.array([math.sin(t)]), np.ones(1))
    return q, spiral(q, t)


def test_it_has_order_four_once_begun_with_unequal_steps_and_its_correction_is_its_error() -> None:
    errors, corrected = [], []
    for number in (20, 40, 80):
        end, (exact, _) = unequal_steps(number), spiral_exact(2.0)
        assert end.t == pytest.approx(2.0, rel=1e-12)
        assert end.past is not None
        errors.append(float(np.linalg.norm(end.q.centres - exact.centres)))
        ahead = end.q.moved(end.past.correction)
        corrected.append(float(np.linalg.norm(ahead.centres - exact.centres)))
    assert slope(errors) == pytest.approx(4.0, abs=0.15)
    assert slope(corrected) == pytest.approx(4.0, abs=0.15)
    assert corrected[-1] < errors[-1]


def test_it_begins_with_a_trapezium() -> None:
    """With no velocity before: p = q + h U_0 is where it solves; it goes on from q + (U_0 + U_1) h / 2."""
    q, U_0 = spiral_exact(0.0)
    trial = Adams().step(Field(spiral), State(0.0, 0, q, U_0, 0.1), 0.1)
    U_1 = spiral(q.moved(0.1 * U_0), 0.1)
    assert trial.q.centres == pytest.approx(q.moved(0.1 * U_0).centres, rel=1e-14)
    assert trial.error == pytest.approx(0.05 * (U_1 - U_0), rel=1e-13)


def equal_steps(number: int) -> Configuration:
    """Where the spiral ends at t = 2, with nothing known before t = 0."""
    q, U_0 = spiral_exact(0.0)
    state, h = State(0.0, 0, q, U_0, 2.0 / number), 2.0 / number
    for k in range(1, number + 1):
        trial = Adams().step(Field(spiral), state, k * h)
        state = State(k * h, k, trial.q, trial.instant.U, h, trial.past)
    return state.q


def test_equal_steps_from_the_start_have_the_order_of_the_registry() -> None:
    """What the first of them misses, h^3, is never made good."""
    exact, _ = spiral_exact(2.0)
    errors = [float(np.linalg.norm(equal_steps(n).centres - exact.centres)) for n in (80, 160, 320)]
    assert slope(errors) == pytest.approx(SCHEMES["adams"].order, abs=0.15)
