"""Apparent viscosities of several levels over time: by hand, and of a sheared pair by one command."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from fsi.case.load import parse_case
from fsi.comparison.viscosity import viscosity_histories
from tests.commands import fsi_command

T = np.linspace(0.0, 1.0, 5)


def test_curves_are_compared_as_long_as_they_run_and_agree_up_to_two_per_cent() -> None:
    """mu = 2 + t, and 2 + t + (2 + t) t / 10: apart by t / 10, above 2 % from t = 0.2 on."""
    other = {"t": 2.0 * T, "apparent_viscosity": (2.0 + 2.0 * T) * (1.0 + 0.2 * T)}
    nothing = {"t": T, "apparent_viscosity": np.full(5, np.nan)}
    levels = {
        "resolved": {"t": T, "apparent_viscosity": 2.0 + T},
        "pores": other,
        "reduced": nothing,
        "gluey": {"t": T},
    }
    found = viscosity_histories(levels)
    assert found is not None
    assert list(found.mu) == ["resolved", "pores"]
    assert (found.t[0], found.t[-1]) == (0.0, 1.0)
    assert found.differences["pores"] == pytest.approx(0.1 * found.t, abs=1e-12)
    assert found.agree_until == pytest.approx({"resolved": 1.0, "pores": 0.2}, abs=2e-3)
    assert viscosity_histories({"resolved": levels["resolved"], "reduced": nothing}) is None


def test_one_command_draws_resolved_and_pores_over_each_other(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two discs in a sheared cell; with four modes the curves are 1e-3 apart, of viscosities of 1.5."""
    bodies = [
        {"name": "one", "radius": 1.0, "position": [1.6, 1.5]},
        {"name": "other", "radius": 0.7, "position": [3.3, 2.2]},
    ]
    data = {
        "name": "sheared",
        "fluid": {"viscosity": 1.0},
        "domain": {"shape": "cell", "vectors": [[5.0, 0.0], [0.0, 4.0]], "shear": 1.0},
        "bodies": bodies,
        "pores": {"modes": 4},
        "time": {"end": 0.05, "tolerance": 1e-2},
        "output": {"fields": False},
    }
    file = tmp_path / "case.toml"
    file.write_text(parse_case(data).as_toml())
    out = tmp_path / "both"
    assert fsi_command("compare", file, "--levels", "resolved,pores", "-o", out) == 0
    said = capsys.readouterr().out
    assert "sheared: apparent viscosity" in said
    assert "until" in said
    found = json.loads((out / "comparison.json").read_text())["apparent_viscosity"]
    assert 0.0 < found["largest_difference"]["pores"] < 2e-3
    assert found["agree_until"]["pores"] == pytest.approx(0.05)
    assert (out / "comparison.png").read_bytes().startswith(b"\x89PNG")
