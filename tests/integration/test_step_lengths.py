"""How long steps are, of bodies whose velocities are given functions of place and time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.errors import SolveError
from fsi.integration.schemes import BogackiShampine
from fsi.integration.state import Instant, Model, Schedule, State, Trial
from fsi.integration.stepper import Stepper
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.round import HalfPlane
from tests.integration.stepping import run
from tests.integration.test_schemes import Field


def drift(q: Configuration, _: float) -> Array:
    """Uniform motion, in which every step is exact."""
    return np.ones((len(q), 3))


def in_a_large_box(velocity: Callable[[Configuration, float], Array]) -> Stepper:
    box = Box((-1e4, -1e4), (1e4, 1e4))
    return Stepper(Field(velocity), BogackiShampine(), box, "abcd", Schedule(4.0), 1e-4, 0.2, 1e-9)


def repulsion(q: Configuration, _: float) -> Array:
    """Discs that repel and turn each other: a field without preferred direction."""
    separation = q.centres[:, None] - q.centres[None]
    distance = np.hypot(separation[..., 0], separation[..., 1]) + np.eye(len(q))
    push = (separation / distance[..., None] ** 3).sum(axis=1)
    return np.column_stack([push, (1.0 - np.eye(len(q))).sum(axis=1) / distance.sum(axis=1)])


CENTRES = np.array([[0.0, 0.0], [3.0, 0.5], [0.5, 2.7], [-2.5, 2.0]])
RADII = np.array([1.0, 1.2, 0.7, 1.1])


@given(angle=st.floats(0.0, 6.28), order=st.permutations(range(4)))
def test_motion_does_not_depend_on_the_frame_nor_on_the_order_of_bodies(
    angle: float, order: list[int]
) -> None:
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    first = run(in_a_large_box(repulsion), Configuration(CENTRES, np.zeros(4), RADII))
    second = run(
        in_a_large_box(repulsion), Configuration((CENTRES @ turn.T)[order], np.zeros(4), RADII[order])
    )
    assert len(first) == len(second) > 3
    a, b = first[-1].state, second[-1].state
    assert b.q.centres == pytest.approx((a.q.centres @ turn.T)[order], abs=1e-9)
    assert b.q.angles == pytest.approx(a.q.angles[order], abs=1e-9)


def test_a_step_cut_short_to_land_does_not_shorten_the_next() -> None:
    stepper = replace(in_a_large_box(drift), schedule=Schedule(4.0, kinks=(1.0, 1.001)), first_step=1.0)
    start = stepper.start(Configuration(np.zeros((1, 2)), np.zeros(1), np.ones(1)))
    first = stepper.advance(start.state)
    second = stepper.advance(first.state)
    assert (first.state.t, second.state.t) == (1.0, 1.001)
    assert second.state.h == first.state.h == 2.0


class Estimated:
    """A scheme that follows a uniform motion, with an estimate that is so many tolerances, of order 3."""

    error_order: ClassVar[int] = BogackiShampine.error_order

    def __init__(self, *errors: float) -> None:
        self.errors = list(errors)

    def start(self, model: Model, q: Configuration) -> tuple[Instant, Array]:
        instant = model(q, 0.0)
        return instant, instant.U

    def step(self, model: Model, state: State, t_end: float) -> Trial:
        q = state.q.moved((t_end - state.t) * state.U)
        error = np.zeros_like(state.U)
        error[0, 0] = 1e-4 * self.errors.pop(0)
        return Trial(q, model(q, t_end), error)


@pytest.mark.parametrize(
    ("errors", "h"),
    [
        ((1.0 / 8.0,), 1.8),
        ((0.729,), 1.0),
        ((1e-9,), 2.0),
        ((2.0, 1e-9), 0.5),
        ((8.0, 1.0), 0.405),
        ((1e6, 1e-9), 0.1),
    ],
)
def test_the_next_step_is_that_of_a_third_order_estimate(errors: tuple[float, ...], h: float) -> None:
    """0.9 error^(-1/3), at most 2; after a rejection, which cuts the step to a half or less, at most 1."""
    stepper = replace(in_a_large_box(drift), scheme=Estimated(*errors), first_step=1.0)
    start = stepper.start(Configuration(np.zeros((1, 2)), np.zeros(1), np.ones(1)))
    step = stepper.advance(start.state)
    assert step.rejected == len(errors) - 1
    assert step.state.h == pytest.approx(h, rel=1e-12)


def test_an_estimate_that_is_no_number_is_the_fault_of_the_scheme() -> None:
    """No step is short enough for it, and none below `smallest_step` would be."""
    stepper = replace(in_a_large_box(drift), scheme=Estimated(math.nan), first_step=1.0)
    start = stepper.start(Configuration(np.zeros((1, 2)), np.zeros(1), np.ones(1)))
    with pytest.raises(SolveError, match=r"^time\.scheme: its error of the step to t = 1 is not a number;"):
        stepper.advance(start.state)


def circle(q: Configuration, _: float) -> Array:
    """Round the origin with angular velocity 1, without turning."""
    x, y = q.centres.T
    return np.column_stack([-y, x, np.zeros(len(q))])


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_a_lone_body_on_a_curved_way_is_held_to_the_tolerance(tolerance: float) -> None:
    """No gap is near: the error of its place alone chooses the steps, and dozens of tolerances add up."""
    stepper = replace(in_a_large_box(circle), tolerance=tolerance)
    steps = run(stepper, Configuration(np.array([[5.0, 0.0]]), np.zeros(1), np.ones(1)))
    assert (
        math.dist(steps[-1].state.q.centres[0], (5.0 * math.cos(4.0), 5.0 * math.sin(4.0)))
        < 200.0 * tolerance
    )
    assert len(steps) > 0.5 * tolerance ** (-1.0 / 3.0)


def test_a_lone_body_that_turns_faster_and_faster_is_held_to_the_tolerance() -> None:
    """omega = exp(2 t) and no other motion, so that its angle is (exp(8) - 1)/2 at t = 4."""

    def spin(q: Configuration, t: float) -> Array:
        return np.column_stack([np.zeros((len(q), 2)), np.exp(2.0 * t) * np.ones(len(q))])

    steps = run(in_a_large_box(spin), Configuration(np.zeros((1, 2)), np.zeros(1), np.ones(1)))
    assert steps[-1].state.q.angles[0] == pytest.approx(0.5 * math.expm1(8.0), abs=0.05)
    assert len(steps) > 100


def test_two_near_bodies_that_part_are_held_to_their_gap() -> None:
    """D' = D from 1e-3: an error of 1e-4 of the radius would be a tenth of the gap."""

    def parting(q: Configuration, _: float) -> Array:
        gap = float(np.linalg.norm(q.centres[1] - q.centres[0])) - 2.0
        return np.array([[0.0, 0.0, 0.0], [gap, 0.0, 0.0]])

    q = Configuration(np.array([[0.0, 0.0], [2.001, 0.0]]), np.zeros(2), np.ones(2))
    end = run(in_a_large_box(parting), q)[-1].state.q
    assert end.centres[1, 0] - 2.0 == pytest.approx(1e-3 * math.exp(4.0), rel=2e-3)


def test_the_model_sees_no_gap_that_has_lost_more_than_it_may() -> None:
    """A fifth, at every stage: a disc at rest that is then drawn to the plane faster than a step foresees."""
    seen: list[float] = []

    def falling(q: Configuration, t: float) -> Array:
        seen.append(q.centres[0, 1] - 1.0)
        return np.array([[0.0, -100.0 * t, 0.0]])

    stepper = replace(in_a_large_box(falling), container=HalfPlane(1e4), tolerance=1.0, first_step=0.5)
    state = stepper.start(Configuration(np.array([[0.0, 2.0]]), np.zeros(1), np.ones(1))).state
    for _ in range(20):
        before = len(seen)
        gap = state.q.centres[0, 1] - 1.0
        state = stepper.advance(state).state
        assert min(seen[before:]) >= 0.8 * gap * (1.0 - 1e-12)
