"""The laws that a reduced case takes from files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fsi.case.law_file import LawFile, TableSection, save_law
from fsi.errors import InputError
from fsi.models import make_model
from tests.reduced_data import reduced_case

TABLE = TableSection(s=(1e-3, 1.0), K=(4000.0, 2.0))
DISC = {"name": "disc", "radius": 1.0, "position": [0.0, 1.1], "force": [0.0, -1.0]}


def velocity(path: Path, viscosity: float) -> float:
    """V_y of a disc above a plane with almost no drag but that of its gap."""
    reduced = {"law": str(path), "drag": 1e-9}
    case = reduced_case([DISC], reduced, fluid={"viscosity": viscosity})
    return float(make_model(case)(case.configuration(), 0.0).U[0, 1])


def test_a_law_is_scaled_to_the_viscosity_of_the_fluid(tmp_path: Path) -> None:
    """Calibrated at mu = 1, used at mu = 0.003: at its own viscosity the disc would be 333 times as slow."""
    save_law(tmp_path / "law.toml", LawFile(form="table", shape="discs", viscosity=1.0, table=TABLE))
    K = np.exp(np.interp(np.log(0.1), np.log(TABLE.s), np.log(TABLE.K)))
    for mu in (1.0, 0.003):
        assert velocity(tmp_path / "law.toml", mu) == pytest.approx(-1.0 / (mu * K), rel=1e-6)


@pytest.mark.parametrize(("shape", "mode"), [("spheres", "squeeze"), ("discs", "shear")])
def test_a_law_of_something_else_is_refused(shape: str, mode: str, tmp_path: Path) -> None:
    path = tmp_path / "law.toml"
    save_law(path, LawFile.model_validate(
        {"form": "table", "shape": shape, "mode": mode, "viscosity": 1.0, "table": TABLE}
    ))  # fmt: skip
    with pytest.raises(InputError, match=f"a law of {mode} between {shape}; give one of squeeze"):
        velocity(path, 1.0)
