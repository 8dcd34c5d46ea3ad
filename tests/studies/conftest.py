"""For tests of sweeps: a case, and runs that stay in this process."""

from __future__ import annotations

from pathlib import Path

import pytest

from fsi.errors import FsiError
from fsi.studies.member import compute
from fsi.workers import launch

CASE = """
name = "four discs at random"
model = "reduced"
fluid.viscosity = 1.0
domain.walls.top = [1.0, 0.0]
arrangement = { kind = "random", number = 4, area_fraction = 0.3, gap = 0.02 }
reduced = { drag = 10.0, cutoff = 1.0, shear_law = "exact", rotation_law = "exact" }
time = { end = 0.2, first_step = 0.1 }
"""


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "four.toml"
    path.write_text(CASE)
    return path


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Runs in this process, one after the other, and in which order they were begun."""
    begun: list[str] = []

    def launched(_: str, folder: str, __: int) -> str:
        begun.append(Path(folder).name)
        try:
            compute(Path(folder))
        except FsiError as error:
            return str(error)
        return ""

    monkeypatch.setattr(launch, "launched", launched)
    return begun


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fsi.postprocess.plots.sweep.plot_sweep", lambda *_: None)
