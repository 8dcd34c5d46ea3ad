"""Means over time from few steps."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.errors import SolveError
from fsi.studies.means import energy_relaxed, mean_dissipation, mean_over_time, require_enough


def test_means_of_long_steps_follow_what_bends() -> None:
    """(1/2 + 3t/2)^2 has the mean 7/4; by straight lines between these steps of a run it is 1.81."""
    t = np.array([0.0, 0.17, 0.52, 1.0])
    value, error = mean_over_time(t, (0.5 + 1.5 * t) ** 2)
    assert value == pytest.approx(1.75, rel=1e-3)
    assert error == pytest.approx(1.8094 - 1.75, rel=0.05)


@pytest.mark.parametrize(("loss", "most"), [(0.2, 1e-3), (0.5, 0.04), (0.6, 0.09)])
def test_means_towards_contact_stay_between_the_steps(loss: float, most: float) -> None:
    """q^(-3/2) of a gap q = 1 - t that loses a part in each step; splines were 34 times too large at 0.5."""
    q = (1.0 - loss) ** np.arange(np.ceil(np.log(1e-5) / np.log1p(-loss)) + 1.0)
    exact = 2.0 * (q[-1] ** -0.5 - 1.0) / (1.0 - q[-1])
    value, error = mean_over_time(1.0 - q, q**-1.5)
    assert error is not None
    assert abs(value - exact) < min(error, most * exact)


def test_errors_of_means_do_not_cancel() -> None:
    """cos 5t/2 has the mean sin(5/2) / (5/2) up to t = 1; with signs the error is 308 times too small."""
    t = np.linspace(0.0, 1.0, 9) ** 2
    value, error = mean_over_time(t, np.cos(2.5 * t))
    assert error is not None
    off = abs(value - np.sin(2.5) / 2.5)
    assert off < error < 5.0 * off


def test_means_do_not_go_round_kinks() -> None:
    """|t - 1| from 0 to 3 has the mean 5/6; one monotone cubic through its steps is 4 % off."""
    t = np.array([0.0, 0.4, 1.0, 1.3, 2.0, 3.0])
    assert mean_over_time(t, np.abs(t - 1.0), (1.0, 7.0))[0] == pytest.approx(5.0 / 6.0, rel=1e-14)
    assert mean_over_time(t, np.abs(t - 1.0))[0] != pytest.approx(5.0 / 6.0, rel=1e-3)


def test_a_mean_of_what_is_infinite_is_no_number_to_go_on_with() -> None:
    assert mean_over_time(np.array([0.0, 1.0, 2.0]), np.array([1.0, np.inf, 1.0]))[0] == np.inf
    assert mean_over_time(np.zeros(1), np.array([2.0]))[0] == 2.0


def test_a_step_that_ends_a_rounding_before_a_kink_ends_at_it() -> None:
    """3 * 0.35 is 1.0499999999999998: with the row after it the piece had three times, and a cubic."""
    t = np.array([0.0, 0.35, 0.7, 3 * 0.35, 1.4, 1.75])
    assert t[3] < 1.05
    with pytest.raises(
        SolveError, match=r"no step between t = 0\.7 and 1\.05; give output\.interval = 0\.0437$"
    ):
        require_enough(t, (0.7, 1.05), "dissipation")
    bent = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0])  # straight from kink to kink
    assert mean_over_time(t, bent, (0.7, 1.05, 1.4))[0] == pytest.approx(0.35 / 1.75, rel=1e-14)


@pytest.mark.parametrize("first", [1e-4, 0.01, 0.1, 0.5, 1.0, 2.0, 4.0, 30.0, 1e4])
@pytest.mark.parametrize(("begun", "f", "u"), [(1.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, 0.0, 1.0)])
def test_the_mean_dissipation_of_a_body_that_is_soon_stopped_holds_its_bar(
    first: float, begun: float, f: float, u: float
) -> None:
    """m U' = f + u - U in a fluid that moves at u, D = (U - u)^2; each step is twice the one before.

    The first is that times the relaxation time m. The mean is f^2 + m (w^2 / 2 + 2 f w) / T with w the
    velocity lost. By the value at time 0 half the first step had it: 5000 times the energy of the body.
    """
    m, w = 1e-3, begun - u - f
    t = m * first * np.append(0.0, 2.0 ** np.arange(24.0 - np.log2(first)).round())
    U = u + f + w * np.exp(-t / m)
    relaxed = energy_relaxed(np.array([[m]]), U[:1, None], U[1:2, None])
    mean, error = mean_dissipation(t, (U - u) ** 2, (), relaxed)
    assert error is not None
    assert abs(mean - f**2 - m * (w**2 / 2.0 + 2.0 * f * w) / t[-1]) <= error * (1.0 + 1e-9)
    assert error * t[-1] < 5.0 * m


def test_the_energy_of_a_body_that_stops_is_all_dissipated() -> None:
    """1/2 m U^2, and in the error what it has past the fluid where it does not stop."""
    masses = np.array([[2.0, 2.0, 0.5]])
    before, after = np.array([[3.0, 0.0, 4.0]]), np.array([[0.0, 0.0, 1.0]])
    assert energy_relaxed(masses[:, :2], before[:, :2], after[:, :2]) == (9.0, 9.0)
    assert energy_relaxed(masses, before, after) == (11.25, 11.25 + 2.0 * 0.5 * 3.0)


@pytest.mark.parametrize("rows", [2, 4])
def test_what_changes_in_the_first_step_beside_a_mass_at_rest_is_in_the_bar(rows: int) -> None:
    """t until 1 or 3; that of its end for the whole first step is 1/2 too much of 1/2 or 9/2."""
    t = np.arange(float(rows))
    mean, error = mean_dissipation(t, t, (), (0.0, 1e-9))
    assert error is not None
    assert 0.1 < abs(mean - t[-1] / 2.0) < error < 0.6


def test_the_mean_dissipation_without_mass_is_the_mean() -> None:
    t, D = np.array([0.0, 1.0, 3.0]), np.array([1.0, 2.0, 1.0])
    assert mean_dissipation(t, D, ()) == mean_over_time(t, D)
    assert mean_dissipation(t[:1], D[:1], ()) == (1.0, None)
