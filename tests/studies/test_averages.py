"""Means over the seeds of a sweep."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsi.studies.evaluate import FoundValue
from fsi.studies.sweep import SweepPlan, SweepRow, SweptKey, averages


@given(st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=4, unique=True), st.integers(0, 3))
def test_tables_have_a_row_for_each_point_whatever_failed(values: list[float], seeds: int) -> None:
    """The mean is over what was done; values at x are x + seed there, and the second seed fails."""
    plan = SweepPlan(
        Path(), (), [SweptKey("x", values), SweptKey("word", ["a", "b"])], seeds, ("q",), False, Path()
    )
    found = []
    for point in plan.points():
        for seed in range(1, max(seeds, 1) + 1):
            known = {} if seed == 2 else {"q": FoundValue(point["x"] + seed)}
            found.append(SweepRow(SimpleNamespace(), known))  # type: ignore[arg-type]
    means = averages(plan, found)
    assert [(one.point["x"], one.point["word"]) for one in means] == [(x, w) for x in values for w in "ab"]
    for one in means:
        assert one.count + one.failed == max(seeds, 1)
        assert one.failed == (seeds >= 2)
        expected = one.point["x"] + (2.0 if seeds == 3 else 1.0)  # of 1, or of 1 and 3
        assert one.mean == pytest.approx(expected, rel=1e-12, abs=1e-6)


def test_the_bar_of_a_mean_is_the_largest() -> None:
    """Of runs that have one."""
    plan = SweepPlan(Path(), (), [SweptKey("x", [1.0])], 3, ("q",), False, Path())
    bars = (1e-4, 3e-4, None)
    found = [SweepRow(SimpleNamespace(), {"q": FoundValue(2.0, bar)}) for bar in bars]  # type: ignore[arg-type]
    assert [mean.error for mean in averages(plan, found)] == [3e-4]
