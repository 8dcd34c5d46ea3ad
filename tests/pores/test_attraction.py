"""The shipped case of discs that attract each other: what its page says of clusters."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from fsi.case.load import load_case
from fsi.runs import run

ROOT = Path(__file__).parents[2]
CASE = ROOT / "cases" / "suspensions" / "attraction.toml"


def test_the_rate_of_shear_is_one() -> None:
    case = load_case(CASE)
    u = case.wall_velocity(0.0)
    height = case.container().volume / case.container().periods[0, 0]
    assert (u["top"].velocity[0] - u["bottom"].velocity[0]) / height == pytest.approx(1.0, rel=1e-6)


@pytest.mark.slow
def test_clusters_form_by_attraction(tmp_path: Path) -> None:
    """By strain 1, of thirty: eleven discs in the largest cluster, without attraction two (regression)."""
    history = runpy.run_path(str(ROOT / "docs" / "figures" / "attraction.py"))["history"]
    found = {}
    for name, changes in (("with", []), ("without", ["forces=[]"])):
        run(load_case(CASE, ["time.end=1.0", *changes]), tmp_path / name)
        found[name] = history(tmp_path / name)
    assert (found["with"].largest[-1], found["without"].largest[-1]) == (11, 2)
    assert found["with"].viscosity[-1] > 1.2 * found["without"].viscosity[-1]
    np.testing.assert_array_equal(found["without"].attracted, 0.0)
