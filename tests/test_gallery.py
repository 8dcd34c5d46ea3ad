"""Scripts of the gallery: each makes its picture and asserts its number; `bench/gallery.py` times them."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest
from matplotlib.image import imread

DOCS = Path(__file__).parents[1] / "docs"
EXAMPLES = {path.stem: path for path in sorted((DOCS / "examples").glob("*.py"))}
QUICK = (
    "colliding_blocks",
    "crowd_by_a_law",
    "dilute_viscosity",
    "film_pressure",
    "longer_end",
    "resistance_matrix",
)


@pytest.mark.parametrize(
    "name", [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in EXAMPLES if name not in QUICK)]
)
def test_an_example_runs_and_its_numbers_hold(name: str, tmp_path: Path) -> None:
    picture = tmp_path / f"{name}.png"
    runpy.run_path(str(EXAMPLES[name]))["main"](picture)
    shown = imread(DOCS / "gallery" / f"{name}.png").shape
    assert imread(picture).shape[:2] == shown[:2]  # drawn as it is shown


def test_every_example_has_its_picture_and_asserts_something() -> None:
    assert len(EXAMPLES) >= 15
    assert {path.stem for path in (DOCS / "gallery").glob("*.png")} == {*EXAMPLES}
    for name, path in EXAMPLES.items():
        text = path.read_text(encoding="utf-8")
        assert f"python docs/examples/{name}.py [{name}.png]" in text
        assert "    assert " in text, name
