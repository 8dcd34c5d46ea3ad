"""The line of progress on terminals of all widths."""

from __future__ import annotations

import pytest

from fsi.report.progress import _new_bar

TEXT = "step 12  t = 0.1234  smallest gap 1.234e-05  fastest 0.123"  # as `ProgressBar.show` writes it


@pytest.mark.parametrize(
    ("width", "shown"), [(120, TEXT), (80, TEXT), (40, "step 12  t = 0.123…"), (20, "…")]
)
def test_the_text_gives_way_to_bar_and_percentage(
    width: int, shown: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without that the text took all of 40 columns, and both were gone."""
    monkeypatch.setenv("COLUMNS", str(width))
    bar = _new_bar()
    bar.update(bar.add_task(TEXT, total=10), completed=4)
    with bar.console.capture() as capture:
        bar.console.print(bar.get_renderable())
    (line,) = capture.get().splitlines()
    assert line.startswith(f"{shown} ━")
    assert " 40 % " in line
    assert len(line) <= width
