"""When the smallest gap of a run was so wide, by the rows of its steps."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.errors import InputError
from fsi.observables.quantities import time_at


def test_the_time_at_a_gap_is_exact_for_exponential_decay_and_ignores_what_came_before() -> None:
    t = np.linspace(0.0, 5.0, 40)
    gaps = np.exp(-t)
    assert time_at(0.1, t, gaps)[0] == pytest.approx(np.log(10.0), rel=1e-12)
    rising, earlier = np.concatenate([[0.5, 0.7], gaps]), np.concatenate([[-2.0, -1.0], t])
    assert time_at(0.1, earlier, rising, (0.0,))[0] == pytest.approx(np.log(10.0), rel=1e-12)
    with pytest.raises(InputError, match=r"the smallest gap of the run is 0\.00674; raise time\.end"):
        time_at(1e-3, t, gaps)
    assert time_at(float(gaps[0]), t, gaps) == (t[0], 0.0)
    assert time_at(float(gaps[7]), t, gaps) == (t[7], 0.0)
    with pytest.raises(InputError, match="time at gap 2: the run begins at a gap of 1; give a smaller one"):
        time_at(2.0, t, gaps)


def braked(t: Array) -> Array:
    """A gap of 1 that closes at 0.8 until t = 1, then slower and slower until 1.02, then at 0.02."""
    s = np.clip(t - 1.0, 0.0, 0.02)
    gaps: Array = 1.0 - 0.8 * np.minimum(t, 1.0) - 0.8 * s + 19.5 * s**2 - 0.02 * np.maximum(t - 1.02, 0.0)
    return gaps


@pytest.mark.parametrize(
    ("gap", "exact"),
    [(0.3, 0.875), (0.21, 0.9875), (0.195, 1.0 + 0.3 / 39.0), (0.19, 1.11)],
)
def test_the_time_at_a_gap_is_not_carried_away_by_kinks(gap: float, exact: float) -> None:
    """A spline of t over ln gap through all rows gave 1.06 at 0.21; between both kinks are two rows alone."""
    t = np.array(
        [0.0, 0.0580, 0.1741, 0.3677, 0.5265, 0.6568, 0.7635, 0.8511, 0.9229, 0.9615, 1.0, 1.02, 1.065, 1.155]
    )
    found, error = time_at(gap, t, braked(t), (1.0, 1.02))
    assert abs(found - exact) < min(error, 1e-4 if gap != 0.195 else 5e-3)
    after = int(np.searchsorted(t, exact))
    assert t[after - 1] < found < t[after]


def test_the_time_at_a_gap_that_comes_to_rest_lies_in_its_step() -> None:
    """0.5 - s + 3/4 s^2 is 0.17 at s = 0.6; splines of t over the gap, singular at s = 2/3, gave 0.70."""
    s = np.array([0.0, 0.09, 0.1766, 0.2615, 0.3473, 0.4387, 0.5469, 0.7248, 1.0804, 1.5402, 2.0])
    gaps = 0.5 - s + 0.75 * s**2
    found, error = time_at(0.17, s, gaps)
    assert abs(found - 0.6) < min(error, 2e-3)
    assert 1e12 * time_at(0.17, 1e-12 * s, gaps)[0] == pytest.approx(found, rel=1e-9)  # whatever the unit
    with pytest.raises(
        InputError, match=r"steps is 0\.1692, and it opens at the end; give a wider gap or a shorter out"
    ):
        time_at(0.1667, s, gaps)
    # 0.1692^2 over the higher gap beside it, 0.2951, is 0.0970: no step that is stored between changes that.
    for far in (0.096, 0.03):
        with pytest.raises(InputError, match=r"at the end; give a wider gap, or bodies that come nearer"):
            time_at(far, s, gaps)
    with pytest.raises(InputError, match=r"give a wider gap or a shorter output\.interval"):
        time_at(0.098, s, gaps)
    # Two that pass at 1e-3: 2 (sqrt((1 + 1e-3 / 2)^2 + t^2 / 4) - 1), whose logarithm is no parabola.
    t = np.array([-1.5, -0.5, 0.6, 1.6])
    with pytest.raises(InputError, match=r"give a wider gap or a shorter output\.interval"):
        time_at(1.02e-3, t + 1.5, 2.0 * (np.sqrt(1.0005**2 + 0.25 * t**2) - 1.0))


def test_the_time_at_a_gap_before_contact() -> None:
    """A gap closes at the rate 1 and is closed from t = 1 on; at 0.15 a line of ln gap is off by 8e-3."""
    t = np.array([0.0, 0.5, 0.8, 0.9, 1.0, 1.1])
    gaps = np.array([1.0, 0.5, 0.2, 0.1, 0.0, 0.0])
    found, error = time_at(0.15, t, gaps)
    assert abs(found - 0.85) < min(error, 5e-3)
    assert time_at(0.05, t, gaps) == pytest.approx((0.95, 0.05), rel=1e-12)
    assert time_at(0.0, t, gaps) == (1.0, 0.0)
