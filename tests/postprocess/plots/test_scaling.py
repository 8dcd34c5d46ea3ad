"""The file of a benchmark, and its picture."""

from __future__ import annotations

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from fsi.errors import InputError
from fsi.postprocess.plots.scaling import plot_scaling, write_scaling

CURVES = {"distance": [(1000, 0.025), (10000, 0.148), (100000, 1.068)], "linear": [(10, 1.0), (40, 4.0)]}


def test_draws_each_curve_with_its_exponent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """log(1.068 / 0.025) / log(100) = 0.815 is what three equally spaced points fit; 4 s for 4 N is N^1."""
    write_scaling(tmp_path / "b.json", "a step", "discs", CURVES)
    drawn: list[Figure] = []

    def savefig(figure: Figure, path: Path, **_: object) -> None:
        path.touch()
        drawn.append(figure)

    monkeypatch.setattr(Figure, "savefig", savefig)
    plot_scaling(tmp_path / "b.json", tmp_path / "b.png")
    labels = [text.get_text() for text in drawn[0].axes[0].get_legend().get_texts()]  # type: ignore[union-attr]
    assert labels[:2] == ["distance, $N^{0.82}$", "linear, $N^{1.00}$"]


@pytest.mark.parametrize(
    "text",
    [
        "{}",
        "[1]",
        "no json",
        '{"benchmark": "b", "size": "N", "cpu_seconds": 3}',
        '{"benchmark": "b", "size": "N", "cpu_seconds": {}}',
    ],
)
def test_says_what_is_no_benchmark(text: str, tmp_path: Path) -> None:
    (tmp_path / "b.json").write_text(text)
    with pytest.raises(InputError, match="not the file of a benchmark"):
        plot_scaling(tmp_path / "b.json", tmp_path / "b.png")
