"""A disc settles onto a plane, remeshed at every stage, against the exact law in reference/settling.json."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from fsi.case.load import load_case
from fsi.postprocess.run.run import open_run
from fsi.runs import run

ROOT = Path(__file__).parents[2]
SETTLING = json.loads((ROOT / "tests/reference/settling.json").read_text())
TAU = {float(s): tau for s, tau in SETTLING["disc"]["tau"].items()}
COARSE = ("discretisation.cells_per_circle=28", "discretisation.growth=0.3")


def gap_history(folder: Path, *overrides: str) -> tuple[np.ndarray, np.ndarray]:
    """t and q/a of a run of cases/settling_disc.toml, whose unit of time is 4 pi mu a / F."""
    case = load_case(ROOT / "cases/settling_disc.toml", ("output.fields=false", *overrides))
    run(case, folder)
    table = open_run(folder).columns("steps")
    return table["t"], table["smallest_gap"]


def time_at(gap: float, t: np.ndarray, gaps: np.ndarray) -> float:
    """When the gap was passed; q^(-1/2) is nearly linear in t, so that interpolation costs nothing."""
    return float(CubicSpline(gaps**-0.5, t)(gap**-0.5))


@pytest.mark.parametrize("remesh", [pytest.param("always", marks=pytest.mark.slow), "when-needed"])
def test_settling_times(remesh: str, tmp_path: Path) -> None:
    """Within 1e-3 at q/a = 0.5, 0.1 and 0.01; the leading term of lubrication alone is 10 to 40 % early."""
    t, gaps = gap_history(tmp_path / "run", "time.end=21.5", f'time.remesh="{remesh}"', *COARSE)
    for gap, tau in TAU.items():
        assert time_at(gap, t, gaps) == pytest.approx(tau, rel=1e-3), gap


@pytest.mark.slow
def test_it_never_touches(tmp_path: Path) -> None:
    """Down to q/a = 1e-4 the gap stays positive and within 1e-3 of tau -> 3 / sqrt(2 s) + 0.13588."""
    t, gaps = gap_history(tmp_path / "run")
    assert gaps[-1] < 1e-4
    assert (gaps > 0).all()
    assert time_at(1e-4, t, gaps) == pytest.approx(3 / np.sqrt(2e-4) + 0.135878, rel=1e-3)
    for gap, tau in TAU.items():
        assert time_at(gap, t, gaps) == pytest.approx(tau, rel=1e-3), gap
