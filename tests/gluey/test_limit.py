"""One body above a wall: the exact limit, the first integral at eps > 0, the slides' scheme."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.interpolate import PPoly

from fsi.arrays import Array
from fsi.case.gluey import ContactLaw
from fsi.gluey.contacts import Room
from fsi.gluey.film import SphereFilm, log_gap
from fsi.gluey.limit import ESTIMATES, A, Limit, slides_scheme, solve
from fsi.gluey.step import advance
from fsi.gluey.system import GlueyState, System
from fsi.meshes.geometry.unbounded import Unbounded

REFERENCE: dict[str, Any] = json.loads(
    (Path(__file__).parents[1] / "reference" / "gluey_1d.json").read_text()
)
CASES = ("I1", "I2")
EPS = (1e-1, 1e-2, 1e-4)

# No numbers so small that their quotients overflow.
forces = st.lists(st.integers(-3000, 3000), min_size=1, max_size=6).map(lambda f: 1e-3 * np.array(f))


def piecewise_constant(times: Array, values: Array) -> PPoly:
    """f with `values[k]` on (times[k], times[k + 1]); times has one entry more than values."""
    return PPoly(np.asarray(values, dtype=float)[None, :], times)


def force(case: dict[str, Any]) -> Any:
    times, values = np.array(case["f_breaks"]).T
    return piecewise_constant(np.append(times, case["tend"]), values)


@pytest.mark.parametrize("name", CASES)
def test_the_limit_is_the_closed_form(name: str) -> None:
    """I1: falls at -2t, sticks on (1, 3); I2: arrives at -1, sticks on (1, 4): the reference's `limit`."""
    case = REFERENCE[name]
    limit = Limit.of(case["q0"], case["u0"], force(case))
    t = np.linspace(0.0, case["tend"], 1001)
    if name == "I1":
        q = np.where(t < 1, 1 - t**2, np.where(t < 3, 0.0, (t - 3) ** 2))
        gamma = np.where((t >= 1) & (t < 3), np.where(t < 1.5, -2 * t, -3 + 2 * (t - 1.5)), 0.0)
        contact = (1.0, 3.0)
    else:
        q = np.where(t < 1, 1 - t, np.where(t < 4, 0.0, (t - 4) ** 2 / 2))
        gamma = np.where((t >= 1) & (t < 4), np.where(t < 3, -1.0, -1.0 + (t - 3)), 0.0)
        contact = (1.0, 4.0)
    np.testing.assert_allclose(limit.q(t), q, atol=1e-12)
    np.testing.assert_allclose(limit.gamma(t), gamma, atol=1e-12)
    np.testing.assert_allclose(limit.contacts(), [contact], atol=1e-12)


@given(
    push=st.floats(0.1, 10.0), pull=st.floats(0.1, 10.0), q0=st.floats(1e-3, 10.0), after=st.floats(0.1, 5.0)
)
def test_contact_begins_and_ends_when_it_should(push: float, pull: float, q0: float, after: float) -> None:
    """Arrival at sqrt(2 q0 / push), release when the pull has paid back, where utilde = 0.

    There Q has a double root, by which the release was off by up to 2.5e-8.
    """
    arrival = float(np.sqrt(2.0 * q0 / push))
    turn = arrival + after
    release = turn + turn * push / pull
    f = piecewise_constant(np.array([0.0, turn, 2.0 * release]), np.array([-push, pull]))
    ((begin, end),) = Limit.of(q0, 0.0, f).contacts()
    assert begin == pytest.approx(arrival, rel=1e-14)
    assert end == pytest.approx(release, rel=1e-14)


@pytest.mark.parametrize("eps", EPS)
@pytest.mark.parametrize("name", CASES)
def test_the_path_at_eps_is_the_reference(name: str, eps: float) -> None:
    """High-precision values of the reference; a lost memory would miss them by 1."""
    case = REFERENCE[name]
    key = next(key for key in case["data"] if float(key) == eps)
    t, q, gamma = np.array(case["data"][key]["rows"]).T
    found = solve(case["q0"], case["u0"], force(case), eps, t)
    np.testing.assert_allclose(found.q, q, atol=1e-10)
    np.testing.assert_allclose(found.gamma, gamma, atol=1e-8)


@pytest.mark.parametrize("name", CASES)
def test_the_error_is_eps_times_a_constant(name: str) -> None:
    """sup |q_eps - q| / eps tends to the impact speed (I1: 2) or to sqrt 8 at release (I2), never grows."""
    case = REFERENCE[name]
    limit = Limit.of(case["q0"], case["u0"], force(case))
    t = np.linspace(0.0, case["tend"], 401)
    ratios = [
        np.abs(solve(case["q0"], case["u0"], force(case), eps, t).q - limit.q(t)).max() / eps
        for eps in (1e-4, 1e-6, 1e-8)
    ]
    assert max(ratios) < 3.0
    assert abs(ratios[2] - ratios[1]) < 1e-2


@settings(max_examples=10)
@given(forces, st.floats(-2.0, 2.0))
@example(np.array([-2.0, 2.0, 2.0]), 0.0)  # what is stored in the first second is paid back in the next
def test_the_limit_is_a_projection_of_any_push(values: Array, u0: float) -> None:
    """Random piecewise constant forces: q >= 0, gamma <= 0, q gamma = 0, and the scheme tends to it."""
    f = piecewise_constant(np.arange(len(values) + 1.0), values)
    limit = Limit.of(1.0, u0, f)
    t = np.linspace(0.0, len(values), 60 * len(values) + 1)
    q, gamma = limit.q(t), limit.gamma(t)
    assert q.min() >= 0.0
    assert gamma.max() <= 0.0
    assert np.abs(q * gamma).max() <= 1e-12
    # Every step of the fine scheme follows the same law: it converges to the oracle like h.
    fine = np.linspace(0.0, len(values), 1000 * len(values) + 1)
    found, _, _ = slides_scheme(1.0, u0, np.diff(limit.utilde(fine)), np.diff(fine))
    assert np.abs(found - limit.q(fine)).max() <= 4.0 * 3.0 * len(values) / 1000


@pytest.mark.parametrize("length", [1e-15, 1e9])
def test_contacts_do_not_depend_on_the_unit_of_length(length: float) -> None:
    """Falls 1 at f = -2, is pulled from 1.5 on: contact from 1 to 3. Lengths of 1e-15 were taken for 0."""
    f = piecewise_constant(np.array([0.0, 1.5, 4.0]), length * np.array([-2.0, 2.0]))
    ((begin, end),) = Limit.of(length, 0.0, f).contacts()
    assert (begin, end) == pytest.approx((1.0, 3.0), rel=1e-6)


@given(forces)
def test_the_oracle_agrees_with_a_dense_minimum(values: Array) -> None:
    """The Skorokhod formula with the minimum over many times, added the exact extremes: to 1e-12."""
    f = piecewise_constant(np.arange(len(values) + 1.0), values)
    limit = Limit.of(0.5, 0.0, f)
    t = np.linspace(0.0, len(values), 500 * len(values) + 1)
    u = np.concatenate([[0.0], np.cumsum(values)])
    inside = np.arange(len(values)) - u[:-1] / np.where(values == 0.0, 1.0, values)
    crossing = inside[(inside > np.arange(len(values))) & (inside < np.arange(1, len(values) + 1))]
    dense = np.unique(np.concatenate([t, crossing]))
    k = np.minimum(dense.astype(int), len(values) - 1)
    since = dense - k
    Q_at = 0.5 + np.concatenate([[0.0], np.cumsum(u[:-1] + values / 2)])
    Q = Q_at[k] + u[k] * since + values[k] * since**2 / 2
    expected = Q - np.minimum(0.0, np.minimum.accumulate(Q))
    np.testing.assert_allclose(limit.q(dense), expected, atol=1e-12)


@settings(max_examples=10)
@given(forces, st.floats(0.05, 1.0))
# Arrive so that gamma jumps within the rounding of t; the last, within 1e-14 of a jump of the force.
@example(1e-3 * np.array([-1.0, 0.0, -1734.0]), 0.25)
@example(np.array([-2.0, 1.0, 3.0]), 1.0)
@example(np.array([-0.001, 0.001]), 0.0005)
def test_random_forces_keep_the_error_ratio_bounded(values: Array, q0: float) -> None:
    """|q_eps - q| <= C eps with the same C for eps = 1e-4 and 1e-6."""
    f = piecewise_constant(np.arange(len(values) + 1.0), values)
    limit = Limit.of(q0, 0.0, f)
    t = np.linspace(0.0, len(values), 50)
    for eps in (1e-4, 1e-6):
        found = solve(q0, 0.0, f, eps, t)
        assert np.abs(found.q - limit.q(t)).max() <= 40.0 * eps * len(values)
        assert found.steps <= 5000


@settings(deadline=None)
@given(forces, st.floats(-12.0, 0.0), st.sampled_from([0.0, -1e-3, -3.0, 10.0]), st.floats(-10.0, -2.0))
@example(np.array([1.601, 0.0]), -7.0, -0.001, -10.0)  # touches for 1/4000 of the time
@example(np.array([0.0]), -11.34375, -3.0, -4.07421875)  # a shortest step that nearly lands
def test_no_arrival_is_too_hard(values: Array, log_q0: float, u0: float, log_eps: float) -> None:
    """From crawling to fast, from far and near: an end after few steps, the limit's q, and gamma = w there.

    Where the limit sticks at the end, q_eps has long left the digits of `q' = w - gamma`, so gamma = w.
    """
    f = piecewise_constant(np.arange(len(values) + 1.0), values)
    q0, eps, end = 10.0**log_q0, 10.0**log_eps, float(len(values))
    limit, t = Limit.of(q0, u0, f), np.array([0.0, 0.5 * end, end])
    found = solve(q0, u0, f, eps, t)
    assert found.steps <= 20_000
    scale = 1.0 + abs(u0) * end
    assert np.abs(found.q - limit.q(t)).max() <= (100.0 * eps + 1e-11) * scale * end
    w = float(limit.utilde(end)) + eps * np.log(q0)
    if w < -50.0 * eps and found.q[-1] < 1e-12:
        assert found.gamma[-1] == pytest.approx(w, abs=1e-7)


@pytest.mark.parametrize("name", CASES)
def test_the_slides_scheme_is_of_order_one(name: str) -> None:
    case = REFERENCE[name]
    limit = Limit.of(case["q0"], case["u0"], force(case))
    errors = []
    for n in (250, 500, 1000, 2000):
        t = np.linspace(0.0, case["tend"], n + 1)
        q, _, _ = slides_scheme(case["q0"], case["u0"], np.diff(limit.utilde(t)), np.diff(t))
        errors.append(np.abs(q - limit.q(t)).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 1.0, atol=0.05)


@given(
    st.lists(st.integers(-999, 999).map(lambda f: 1e-3 * f), min_size=1, max_size=40), st.floats(0.01, 2.0)
)
def test_the_slides_store_in_gamma_what_here_is_shared_with_u(impulses: list[float], q0: float) -> None:
    """Their scheme literally: at contact q = 0, u = 0 and gamma = u + impulse + gamma before."""
    h = 0.1
    q, u, gamma = slides_scheme(q0, 0.0, np.array(impulses), np.full(len(impulses), h))
    literal_q, literal_u, literal_gamma = q0, 0.0, 0.0
    for n, impulse in enumerate(impulses):
        u_tilde = literal_u + impulse + literal_gamma
        free = literal_q + h * u_tilde >= 0.0
        literal_q = literal_q + h * u_tilde if free else 0.0
        literal_u, literal_gamma = (u_tilde, 0.0) if free else (0.0, u_tilde)
        assert q[n + 1] == pytest.approx(literal_q, abs=1e-13 * (n + 1))
        assert u[n + 1] + gamma[n + 1] == pytest.approx(literal_u + literal_gamma, abs=1e-13 * (n + 1))
        assert gamma[n + 1] <= 0.0


@given(
    st.lists(st.integers(-999, 999).map(lambda f: 1e-3 * f), min_size=5, max_size=40), st.floats(0.01, 2.0)
)
def test_the_step_of_one_pair_is_the_slides_scheme(impulses: list[float], q0: float) -> None:
    """One body of mass 1 above a wall: projection and case analysis give the same numbers to rounding."""
    h = np.full(len(impulses), 0.1)
    q, u, gamma = slides_scheme(q0, 0.0, np.array(impulses), h)
    system = on_a_line(lambda t: np.array([[impulses[round(t / 0.1)]]]))
    state = GlueyState.at(np.array([[1.0 + q0]]), np.zeros((1, 1)))
    for n in range(len(impulses)):
        state, touching, _ = advance(system, state, 0.1 * n, 0.1)
        memory = touching.gamma.min(initial=0.0)
        found = [state.centres[0, 0] - 1.0, state.U[0, 0], memory]
        np.testing.assert_allclose(found, [q[n + 1], u[n + 1], gamma[n + 1]], atol=1e-13 * (n + 1))


def on_a_line(impulse: Any) -> System:
    room = Room(np.array([[0.0]]), np.array([[1.0]]), Unbounded(dimension=1))
    return System(np.ones(1), np.ones((1, 1)), room, lambda t0, _t1: impulse(t0), ContactLaw(), SphereFilm)


def test_the_tableau_has_its_order() -> None:
    """Order 4: sum b c^k = 1/(k+1), and the trees with A; estimates vanish to order 3, and not to order 4."""
    c = A.sum(axis=1)
    np.testing.assert_allclose([A[-1] @ c**k for k in range(4)], [1, 1 / 2, 1 / 3, 1 / 4], atol=1e-14)
    since = np.append(0.0, c)
    order_3 = np.array([since**0, since, since**2, np.append(0.0, A @ c)])
    np.testing.assert_allclose(order_3 @ ESTIMATES.T, 0.0, atol=1e-14)
    assert np.all(np.abs(ESTIMATES @ since**3) > 0.01)
    trees = [A[-1] @ A @ c, A[-1] @ A @ c**2, A[-1] @ (c * (A @ c)), A[-1] @ A @ A @ c]
    np.testing.assert_allclose(trees, [1 / 6, 1 / 12, 1 / 8, 1 / 24], atol=1e-14)


@given(st.floats(-1e6, 100.0), st.floats(1e-12, 1e3))
def test_log_gap_solves_its_equation(y: float, c: float) -> None:
    assert log_gap(np.exp(y) + c * y, c) == pytest.approx(y, rel=1e-9, abs=1e-9 * (1 + 1 / c if y < 0 else 1))
