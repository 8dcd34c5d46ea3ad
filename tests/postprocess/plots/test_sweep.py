"""Averages of a sweep over its first key."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.container import ErrorbarContainer
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
    assert drawn(values, 0.1, tmp_path, monkeypatch).get_xscale() == scale


@pytest.mark.parametrize(("error", "ends"), [(0.25, [0.75, 1.25]), (np.nan, None)])
def test_a_lone_run_has_its_error_bar(
    error: float, ends: list[float] | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From value - error to value + error; without errors neither it nor its caps in the legend."""
    axes = drawn([1.0, 2.0], error, tmp_path, monkeypatch)
    (bars,) = axes.containers
    assert isinstance(bars, ErrorbarContainer)
    assert bars.has_yerr == (ends is not None)
    assert [line.get_segments()[0][:, 1].tolist() for line in bars.lines[2]] == ([ends] if ends else [])


def test_words_stand_side_by_side_without_lines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And without quotes, half a place from the edges: names are wider than marks."""
    axes = drawn(["resolved", "pores"], 0.1, tmp_path, monkeypatch)
    assert [label.get_text() for label in axes.get_xticklabels()] == ["resolved", "pores"]
    assert axes.get_xlim() == (-0.5, 1.5)
    assert axes.lines[0].get_linestyle() == "None"
    assert drawn([1.0, 2.0], 0.1, tmp_path, monkeypatch).lines[0].get_linestyle() == "-"


def drawn(values: list[Any], error: float, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Axes:
    """The panel of one run at each value, all of which give 1."""
    figures: list[Figure] = []

    def savefig(figure: Figure, path: Path, **_: object) -> None:
        path.touch()
        figures.append(figure)

    monkeypatch.setattr(Figure, "savefig", savefig)
    key = SweptKey("fluid.viscosity", values)
    plan = SweepPlan(folder / "case.toml", [], [key], 0, ["load"], False, folder)
    found = [Average({key.name: value}, "load", 1.0, np.nan, np.nan, 1, 0, error) for value in values]
    plot_sweep(plan, [], found, folder / "a.png")
    return figures[0].axes[0]
