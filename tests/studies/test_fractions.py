"""The shipped study of the apparent viscosity over the area fraction, and its formulas."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from fsi.case.load import load_case
from fsi.studies.evaluate import at_instant

ROOT = Path(__file__).parents[2]
CASE = ROOT / "cases" / "suspensions" / "fractions.toml"
EXAMPLE = ROOT / "docs" / "figures" / "viscosity_over_fraction.py"
MU = "apparent viscosity"


def test_the_formula_begins_as_the_dilute_one_and_lies_above_the_bound() -> None:
    formula = runpy.run_path(str(EXAMPLE))["krieger_dougherty"]
    assert (formula(1e-6) - 1.0) / 1e-6 == pytest.approx(2.0, rel=1e-5)
    phi = np.linspace(0.01, 0.75, 50)
    assert np.all(formula(phi) > 1.0 / (1.0 - phi))


def test_tables_of_sweeps_are_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("pores", "resolved"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "runs.csv").write_text(f"arrangement.area_fraction,{MU}\n0.1,1.2\n0.2,\n")
        text = "arrangement.area_fraction,mean,standard_error\n0.1,1.2,0.01\n0.2,1.6,\n"
        (tmp_path / name / "sweep.csv").write_text(text)
    example = runpy.run_path(str(EXAMPLE))
    example["main"](tmp_path / "pores", tmp_path / "resolved", tmp_path / "drawn.png")
    assert capsys.readouterr().out.splitlines()[1].split()[:3] == ["0.1", "1.2000", "0.01"]
    assert (tmp_path / "drawn.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
@pytest.mark.parametrize("fraction", [0.2, 0.6])
def test_pores_and_cells_agree_on_one_arrangement(fraction: float) -> None:
    """Within the sum of their error bars; neither lies below 1 / (1 - phi)."""
    found = {}
    for model in ("pores", "resolved"):
        case = load_case(CASE, [f"arrangement.area_fraction={fraction}", f"model={model}"])
        found[model] = at_instant(case, [MU]).values[MU]
    pores, resolved = found["pores"], found["resolved"]
    assert pores.error is not None
    assert resolved.error is not None
    assert abs(pores.value - resolved.value) <= pores.error + resolved.error
    assert resolved.value > 1.0 / (1.0 - fraction)
