"""Averages of a sweep over its first key."""

from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from fsi.postprocess.plots.sweep import plot_sweep
from fsi.studies.sweep import Average, SweepPlan, SweptKey


@pytest.mark.parametrize(
    ("values", "scale"),
    [
        ([1e-3, 1.0, 1e3], "log"),
        ([3.0, 0.3, 30.0], "log"),
        ([0.2, 0.3], "linear"),
        ([1.0, 50.0, 100.0], "linear"),
        ([0.0, 1.0, 100.0], "linear"),
        (["a", "b"], "linear"),
    ],
)
def test_values_that_span_decades_are_drawn_by_their_logarithms(
    values: list[Any], scale: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where these are more evenly apart than the values."""
    drawn: list[Figure] = []

    def savefig(figure: Figure, path: Path, **_: object) -> None:
        path.touch()
        drawn.append(figure)

    monkeypatch.setattr(Figure, "savefig", savefig)
    key = SweptKey("fluid.viscosity", values)
    plan = SweepPlan(tmp_path / "case.toml", [], [key], 0, ["load"], False, tmp_path)
    found = [Average({key.name: value}, "load", 1.0, 0.1, 0.1, 1, 0, 0.0) for value in values]
    plot_sweep(plan, [], found, tmp_path / "a.png")
    assert drawn[0].axes[0].get_xscale() == scale
