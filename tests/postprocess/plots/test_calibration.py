"""Figures of laws and their samples."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from fsi.calibration.calibrate import write_calibration
from fsi.postprocess.plots.calibration import plot_calibration
from tests.calibration.test_shapes import law_of_ellipses


def test_legends_cover_no_samples(tmp_path: Path, drawn: list[Figure]) -> None:
    """That of the lower panel, which samples and bands fill, stands above it, where it lay on some."""
    write_calibration(tmp_path / "out", law_of_ellipses())
    plot_calibration(tmp_path / "out", tmp_path / "law.png")
    drawn[0].canvas.draw()
    upper, lower = (axes.get_window_extent() for axes in drawn[0].axes)
    legends = [axes.get_legend() for axes in drawn[0].axes]
    above, between = (legend.get_window_extent() for legend in legends if legend is not None)
    assert upper.y0 > between.y1 > between.y0 > lower.y1
    assert lower.x0 < between.x0 < between.x1 < lower.x1
    lines = drawn[0].axes[0].lines
    points = np.concatenate([line.get_transform().transform(line.get_xydata()) for line in lines])
    assert above.count_contains(points) == 0
