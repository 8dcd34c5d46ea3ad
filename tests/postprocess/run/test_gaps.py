"""The history of gaps in a plot, also where bodies are far apart."""

from pathlib import Path

import numpy as np
import pytest

import fsi
from fsi.case.load import parse_case
from fsi.postprocess.plots.panels import Asked, _gaps
from fsi.runs import run


def test_gaps_of_a_pair_that_parts_go_on(tmp_path: Path) -> None:
    """The gap opens from 1 to 5 at the speed 2, through one diameter; the walls are 990 away."""
    bodies = [
        {"name": name, "radius": 1.0, "position": (x, 0.0), "velocity": (v, 0.0), "angular_velocity": 0.0}
        for name, x, v in (("one", -1.5, -1.0), ("other", 1.5, 1.0))
    ]
    case = parse_case({
        "name": "parting", "model": "reduced",
        "fluid": {"viscosity": 1.0}, "reduced": {"drag": 1.0, "cutoff": 1.0},
        "domain": {"shape": "box", "lower": (-1000.0, -1000.0), "upper": (1000.0, 1000.0)},
        "bodies": bodies, "time": {"end": 2.0, "scheme": "bogacki-shampine"},
    })  # fmt: skip
    run(case, tmp_path / "run")
    opened = fsi.open_run(tmp_path / "run")
    expected = 1.0 + 2.0 * opened.steps["t"].to_numpy()
    np.testing.assert_allclose(opened.steps["smallest_gap"], expected, rtol=1e-12)
    for curve in _gaps(Asked(opened, None, 20)).values():
        assert curve == pytest.approx(expected, rel=1e-12)
