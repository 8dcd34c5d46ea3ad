"""Bars of the gap between two bodies hold where errors cancel in it, by models of NumPy only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia
from fsi.bodies.gaps import nearest_gaps
from fsi.bodies.surface_gap import narrowest_gap
from fsi.case.case import Case
from fsi.integration.errors import ErrorEstimate, StepErrors
from fsi.integration.evolution import Moment
from fsi.integration.state import Instant, State
from fsi.integration.strayed import Strayed
from fsi.integration.strayed_gaps import gap_bar, gap_gradient
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.unbounded import Unbounded
from fsi.models import stepped
from tests.exact_model import ExactInstant, plane_case
from tests.integration.test_strayed import moments, with_bars

CELL = Cell(((9.0, 0.0), (1.0, 2.5)), ((0.0, 0.0), (0.0, 0.0)))


def ellipses(*bodies: tuple[float, float, float]) -> Configuration:
    """Of ratio 2 with centres there, turned by the third."""
    shape = {"kind": "ellipse", "axes": [1.0, 0.5]}
    each = [{"name": f"e{n}", "shape": shape, "position": [*x]} for n, (*x, _) in enumerate(bodies)]
    return plane_case(each, 1.0).configuration().moved(np.array([[0.0, 0.0, turn] for *_, turn in bodies]))


@pytest.mark.parametrize(
    ("q", "container"),
    [
        (Configuration.unturned(np.array([[0.0, 5.0], [1.8, 6.5]]), np.array([1.0, 0.8])), Unbounded()),
        (ellipses((0.0, 5.0, 0.3), (1.7, 5.8, -0.6)), Unbounded()),
        (ellipses((0.0, 1.2, 0.4)), Box((-20.0, 0.0), (20.0, 30.0))),
        (ellipses((0.0, 2.0, 0.3), (2.0, 3.5, -0.6)), CELL),
    ],
    ids=["discs", "ellipses", "an ellipse beside a wall", "an ellipse and an image"],
)
def test_the_gradient_of_the_gap_is_what_its_differences_are(q: Configuration, container: Container) -> None:
    gap, way = narrowest_gap(q, container), 1e-5
    assert gap is not None
    for mode in np.ndindex(len(q), 3):
        unit = np.zeros((len(q), 3))
        unit[mode] = way
        later, earlier = (nearest_gaps(q.moved(e), container).smallest() for e in (unit, -unit))
        assert gap_gradient(q, gap)[mode] == pytest.approx((later - earlier) / (2.0 * way), abs=1e-5)


def test_a_bar_is_between_the_sum_and_the_sum_without_signs() -> None:
    """Of 3 - 1 and 1: 3, and with bars of places 4 and 1.5: 5.5."""
    gradient, e = np.array([[1.0, -1.0, 0.0]]), np.array([[[3.0, 1.0, 9.0]], [[1.0, 0.0, 9.0]]])
    bars = np.array([[4.0, 1.5, 9.0]])
    assert [gap_bar(gradient, e, bars, least) for least in (0.0, 4.0, 6.0)] == [3.0, 4.0, 5.5]


@dataclass
class Passing:
    """Two discs in shear, that resist each other's approach: r' = (y, 0) - n n.(y, 0) / (1 + s), exactly."""

    case: Case

    def __call__(self, q: Configuration, _t: float, _inertia: Inertia | None = None) -> ExactInstant:
        U = np.zeros((2, 3))
        U[:, :2] = np.outer([0.5, -0.5], relative_velocity(0.0, q.centres[0] - q.centres[1]))
        return ExactInstant(U, np.zeros_like(U))

    def errors(self, _q: Configuration, _t: float, _instant: Instant) -> StepErrors:
        none = np.zeros((2, 3))
        return StepErrors(ErrorEstimate(none, none), {})

    def state(self) -> dict[str, NDArray[Any]]:
        return {}

    def restore(self, _state: Mapping[str, NDArray[Any]]) -> None:
        pass


def relative_velocity(_t: float, r: Array) -> Array:
    distance = float(np.hypot(*r))
    n, shear = r / distance, np.array([r[1], 0.0])
    return np.asarray(shear - n * (n @ shear) / (distance - 1.0))


def pair(first: tuple[float, float], end: float, tolerance: float) -> Case:
    """Discs of radius 1 with such a first distance, far above a plane."""
    places = {"a": [0.5 * x + y for x, y in zip(first, (0.0, 100.0), strict=True)]}
    places["b"] = [-0.5 * x + y for x, y in zip(first, (0.0, 100.0), strict=True)]
    bodies = [{"name": name, "radius": 1.0, "position": x} for name, x in places.items()]
    return with_bars(plane_case(bodies, end, tolerance=tolerance))


def passed(first: tuple[float, float], tolerance: float) -> tuple[list[Moment], Array]:
    """The steps of a run, and the exact distances at their ends, (2, steps)."""
    case = pair(first, 8.0, tolerance)
    run = moments(stepped(case, cast(Any, Passing(case))))[1:]
    t = [one.state.t for one in run]
    return run, solve_ivp(relative_velocity, (0.0, t[-1]), first, "DOP853", t, rtol=1e-11, atol=1e-12).y


# The first distance and the tolerance; what errors were over bars of grad s . e alone.
PASSES = [
    ((-2.2, 0.5), 3e-3),  # 91
    ((-2.2, 0.7), 1e-3),  # 52
    ((-2.6, 0.4), 1e-2),  # 8.6
    ((-2.6, 0.5), 1e-2),  # 2.0, at the first step
]


@pytest.mark.parametrize(("first", "tolerance"), PASSES)
def test_bars_of_the_gap_of_discs_that_pass_each_other_hold(
    first: tuple[float, float], tolerance: float
) -> None:
    """Errors are at most 0.70 of them, bars 0.05 of the gap; those without signs are up to 0.19 to 0.96."""
    run, exact = passed(first, tolerance)
    gaps = np.array([one.record.smallest_gap for one in run])
    bars = np.array([one.record.columns["err_smallest_gap"] for one in run])
    assert np.all(np.abs(gaps - (np.hypot(*exact) - 2.0)) < 0.8 * bars)
    assert np.all(bars < 0.08 * gaps)


def test_bars_of_places_that_pass_through_zero_hold() -> None:
    """Of one disc relative to the middle; with the bars of each step alone y was off by 1.19 of one."""
    run, exact = passed((-3.0, 1.5), 1e-2)
    places = np.array([one.state.q.centres[0] - [0.0, 100.0] for one in run])
    bars = np.array([[one.record.body_columns[f"err_{k}"][0] for k in "xy"] for one in run])
    ratios = np.abs(places - 0.5 * exact.T) / bars
    assert 0.3 < ratios.max() < 0.7


def test_the_bar_of_a_gap_to_a_wall_is_that_of_the_height() -> None:
    """Which alone it depends on, also where the distance along it hides what is missed across it."""
    case = plane_case([{"name": "a", "radius": 1.0, "position": [0.0, 1.5]}], 1.0, tolerance=1e-2)
    q, container = case.configuration(), case.container()
    e, farthest = np.zeros((2, 1, 3)), np.array([[[0.0, 1e-4, 0.0]], [[0.0, 2e-4, 0.0]]])
    e[1, 0] = [1e-3, 1e-7, 0.0]
    strayed = Strayed(None, cast(Any, None), e=e, farthest=farthest)
    none = ErrorEstimate(np.zeros((1, 3)), np.zeros((1, 3)))
    height = strayed.body_columns(q, none)["err_y"][0]
    state = State(0.0, 0, q, np.zeros((1, 3)), 1.0)
    assert height == pytest.approx(3e-4, rel=1e-12)
    assert strayed.columns(state, container)["err_smallest_gap"] == pytest.approx(height, rel=1e-9)


def test_a_resumed_run_has_the_same_bars_of_gap_and_places() -> None:
    """At step 30 of 50 grad s . e has been longer before, and so has x."""
    case = pair((-2.2, 0.5), 8.0, 3e-3)
    first, again = (stepped(case, cast(Any, Passing(case))) for _ in range(2))
    state = first.start().state
    for _ in range(30):
        state = first.advance(state).state
    again.restore(first.memory())
    ends = [one.advance(state).record for one in (first, again)]
    assert ends[0].columns["err_smallest_gap"] == ends[1].columns["err_smallest_gap"]
    assert ends[0].body_columns["err_x"].tolist() == ends[1].body_columns["err_x"].tolist()


@dataclass
class Sinking:
    """Two bodies that sink alike, of both of which elements may miss `missed` of the velocity."""

    missed: float

    def __call__(self, _q: Configuration, _t: float, _inertia: Inertia | None = None) -> ExactInstant:
        U = np.tile([0.0, -1.0, 0.0], (2, 1))
        return ExactInstant(U, U)

    def errors(self, _q: Configuration, _t: float, instant: Instant) -> StepErrors:
        delta, none = self.missed * instant.U, np.zeros((2, 3))
        return StepErrors(ErrorEstimate(np.abs(delta), none), {}, np.stack([delta, none]))


def test_what_elements_miss_of_two_bodies_need_not_be_alike() -> None:
    """A tenth of both, 0.1 (1e-3 + 1e-3) t, of what each may have strayed by; it was 0."""
    last = moments(stepped(pair((0.0, 3.0), 2.0, 1e-2), cast(Any, Sinking(1e-3))))[-1]
    assert last.record.columns["err_smallest_gap"] == pytest.approx(0.1 * 2e-3 * 2.0, rel=1e-9)


@dataclass
class Flipping(Sinking):
    """The same, of which elements seem to miss more and less in turn, as where pores change at each step."""

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:
        self.missed *= -1.0
        return super().errors(q, t, instant)


def test_what_elements_miss_does_not_cancel_where_its_sign_turns_at_each_step() -> None:
    """All may be missed one way, 1e-3 t, of which sums with these signs have 0."""
    run = moments(stepped(pair((0.0, 3.0), 2.0, 1e-2), cast(Any, Flipping(1e-3))))
    assert len(run) > 4
    for one in run:
        assert one.record.body_columns["err_y"] == pytest.approx([1e-3 * one.state.t] * 2, rel=1e-9)
