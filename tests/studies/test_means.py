"""Means over time from few steps."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.studies.means import mean_over_time


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


def test_means_do_not_go_round_kinks() -> None:
    """|t - 1| from 0 to 3 has the mean 5/6; one monotone cubic through its steps is 4 % off."""
    t = np.array([0.0, 0.4, 1.0, 1.3, 2.0, 3.0])
    assert mean_over_time(t, np.abs(t - 1.0), (1.0, 7.0))[0] == pytest.approx(5.0 / 6.0, rel=1e-14)
    assert mean_over_time(t, np.abs(t - 1.0))[0] != pytest.approx(5.0 / 6.0, rel=1e-3)


def test_a_mean_of_what_is_infinite_is_no_number_to_go_on_with() -> None:
    assert mean_over_time(np.array([0.0, 1.0, 2.0]), np.array([1.0, np.inf, 1.0]))[0] == np.inf
    assert mean_over_time(np.zeros(1), np.array([2.0]))[0] == 2.0
