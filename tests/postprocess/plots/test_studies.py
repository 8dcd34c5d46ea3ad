"""The pictures of `fsi limit`, and of `fsi compare` at any levels."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from fsi.case.gluey import LimitStudy
from fsi.case.load import parse_case
from fsi.comparison.motion import Trajectories
from fsi.comparison.viscosity import ViscosityHistories
from fsi.gluey import limit_study
from fsi.gluey.limit import Path as Solution
from fsi.postprocess.plots.studies import plot_levels, plot_limit
from tests.commands import fsi_command

CASE = Path(__file__).parents[3] / "cases" / "gluey" / "pushed_then_pulled.toml"


def test_another_suffix_is_refused_before_the_solve(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(limit_study, "study", lambda _: pytest.fail("it is solved"))
    assert fsi_command("limit", CASE, "-o", tmp_path / "limit.foo") == 2
    told = "limit.foo: give the path of a .png, .svg or .pdf file in a folder that exists"
    assert told in capfd.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_gap_and_memory_are_drawn(tmp_path: Path) -> None:
    t = np.linspace(0.0, 1.0, 5)
    solution = Solution(t, 1.0 - 0.5 * t, -t, 4)
    wanted, none = LimitStudy(eps=(1e-2,), steps=(4,)), np.zeros(1)
    study = limit_study.Study(t, 1.0 - t, -t, (solution,), none, none, none, [], wanted)
    plot_limit("a disc", study, tmp_path / "limit.png")
    assert (tmp_path / "limit.png").read_bytes().startswith(b"\x89PNG")


def run_of(viscous: bool) -> Any:
    """A run to t = 2 of a disc in a cell that is sheared at rate 3, with or without an apparent viscosity."""
    cell = {"shape": "cell", "vectors": [[4.0, 0.0], [0.0, 4.0]], "shear": 3.0}
    disc = [{"name": "disc", "radius": 1.0, "position": [0.0, 0.0]}]
    case = parse_case({"name": "cell", "fluid": {"viscosity": 1.0}, "domain": cell, "bodies": disc})
    steps = pd.DataFrame({"t": [0.0, 1.0, 2.0]} | ({"apparent_viscosity": 1.5} if viscous else {}))
    return SimpleNamespace(case=case, steps=steps)


@pytest.mark.parametrize(("least", "panels"), [(0.2, 1), (0.0, 2)])
@pytest.mark.parametrize("viscous", [True, False])
def test_levels_are_drawn_as_histories_are(
    least: float, panels: int, viscous: bool, tmp_path: Path, drawn: list[Figure]
) -> None:
    """Gaps from 1 down to 0.2 have one panel, those down to 0 one more; strain is rate times time."""
    t = np.linspace(0.0, 2.0, 21)
    gaps = dict.fromkeys(("resolved", "pores"), (1.0 - (1.0 - least) * 0.5 * t)[:, None])
    viscosities = ViscosityHistories(t, dict.fromkeys(gaps, 1.0 + t)) if viscous else None
    runs = {level: run_of(viscous=viscous) for level in gaps}
    plot_levels(runs, Trajectories(t, gaps), viscosities, tmp_path / "levels.png")
    axes = drawn[0].axes
    titles = ["smallest gap", "smallest gap above 0"][:panels]
    assert [panel.get_ylabel() for panel in axes] == titles + (["apparent viscosity"] if viscous else [])
    assert [panel.get_yscale() for panel in axes[:panels]] == ["linear", "log"][:panels]
    assert axes[-1].get_xlabel() == ("strain" if viscous else "t")
    x = np.asarray(axes[0].lines[0].get_xdata())
    np.testing.assert_allclose(x, 3.0 * t if viscous else t, atol=1e-12)
