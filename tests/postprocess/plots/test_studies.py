"""The picture of `fsi limit`."""

from pathlib import Path

import numpy as np
import pytest

from fsi.case.gluey import LimitStudy
from fsi.gluey import limit_study
from fsi.gluey.limit import Path as Solution
from fsi.postprocess.plots.studies import plot_limit
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
