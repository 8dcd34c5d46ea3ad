from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsi.integration.state import Schedule

END = 10.0


@given(
    kinks=st.lists(st.floats(-1.0, 12.0), max_size=4),
    interval=st.none() | st.floats(0.05, 3.0),
    h=st.floats(0.1, 20.0),
)
def test_every_stop_is_met_without_slivers(kinks: list[float], interval: float | None, h: float) -> None:
    schedule = Schedule(END, tuple(sorted(set(kinks))), interval)
    times = [0.0]
    while times[-1] < END:
        left = schedule.next_stop(times[-1]) - times[-1]
        step = schedule.landing(times[-1], h) - times[-1]
        assert min(left, h / 2) * (1 - 1e-9) <= step <= min(left, 1.1 * h) * (1 + 1e-9)
        times.append(times[-1] + step if step < left else schedule.next_stop(times[-1]))
    assert times[-1] == END
    stops = [kink for kink in kinks if 0.0 <= kink <= END]
    outputs = [k * interval for k in range(int(END / interval) + 1)] if interval else times
    for stop in stops + outputs:
        assert min(abs(stop - t) for t in times) <= 1e-11
    written = [t for t in times if schedule.is_output(t)]
    assert len(outputs) <= len(written) <= len(outputs) + 1


def test_multiples_that_round_differently_are_one_time() -> None:
    """3 * 0.1 is not 0.3."""
    schedule = Schedule(1.0, kinks=(0.3,), interval=0.1)
    times = [0.0]
    while times[-1] < 1.0:
        times.append(schedule.landing(times[-1], 1.0))
    assert len(times) == 11
    assert all(schedule.is_output(t) for t in times)
    assert not schedule.is_output(0.25)


@pytest.mark.parametrize(
    ("stop", "end"), [(1.09, 1.09), (1.11, 0.555), (1.5, 0.75), (1.99, 0.995), (2.5, 1.0), (0.3, 0.3)]
)
def test_a_step_of_about_one_ends_on_a_stop_or_well_before_it(stop: float, end: float) -> None:
    """Stretched by at most a tenth; below two steps it is halved, so that no sliver is left."""
    assert Schedule(10.0, kinks=(stop,)).landing(0.0, 1.0) == pytest.approx(end, rel=1e-14)


def test_times_near_each_other_are_two_times() -> None:
    """A kink 1e-9 of the end after another is met, too: only rounding is overlooked."""
    schedule = Schedule(1.0, kinks=(0.5, 0.5 + 1e-9))
    assert schedule.landing(0.5, 0.1) == 0.5 + 1e-9
    assert Schedule(1.0, kinks=(0.5, 0.5 + 1e-13)).landing(0.5, 0.1) > 0.5 + 1e-3


def test_the_end_is_an_output_also_between_two() -> None:
    schedule = Schedule(1.0, interval=0.3)
    assert schedule.is_output(1.0)
    assert [schedule.is_output(t) for t in (0.0, 0.3, 0.5, 0.6, 0.95)] == [True, True, False, True, False]
