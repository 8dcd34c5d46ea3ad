"""Ranks agree in space, by factors and by iterations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests.ranks import json_on, needs_mpi
from tests.stokes.spatial_flows import BOX, case

# Two spheres at opposite ends of a long box.
APART = BOX | {
    "domain": {"lower": [-2.0, -2.0, -9.0], "upper": [2.0, 2.0, 9.0]},
    "bodies": [
        {"name": name, "radius": 1.0, "position": [0.0, 0.0, z],
         "velocity": [0.0, 0.0, -1.0], "angular_velocity": [0.0, 0.0, 0.0]}
        for name, z in (("low", -6.0), ("high", 6.0))
    ],
}  # fmt: skip


@pytest.mark.mpi
@needs_mpi
@pytest.mark.parametrize(
    ("solver", "several"),
    [
        ("direct", (3,)),
        pytest.param("direct", (2,), marks=pytest.mark.slow),
        pytest.param("iterative", (2, 3), marks=pytest.mark.slow),
    ],
)
def test_ranks_agree_in_space(tmp_path: Path, solver: str, several: tuple[int, ...]) -> None:
    path = tmp_path / "case.toml"
    path.write_text(case(BOX, solver=solver, cells_per_circle=8, growth=1.0).as_toml())
    found = [np.array(json_on(ranks, "resistance", path)["resistance"]) for ranks in (1, *several)]
    for other in found[1:]:
        assert_allclose(other, found[0], atol=1e-9 * np.abs(found[0]).max())


@pytest.mark.mpi
@needs_mpi
def test_ranks_agree_on_a_flow_by_iterations(tmp_path: Path) -> None:
    """The matrix of two ranks is in parts; one of them has no cell that meets a body whose motion it has."""
    path = tmp_path / "case.toml"
    path.write_text(case(APART, solver="iterative", cells_per_circle=7, growth=1.0).as_toml())
    one, two = ([body["force"] for body in json_on(ranks, "solve", path)["bodies"]] for ranks in (1, 2))
    assert_allclose(two, one, atol=1e-9 * np.abs(one).max())


@pytest.mark.slow
@pytest.mark.mpi
@needs_mpi
def test_ranks_agree_on_the_default_sphere() -> None:
    """On two ranks factors of its coarsest matrix take a third more workspace than MUMPS reckons with."""
    path = Path(__file__).parents[2] / "cases" / "validation" / "sphere_in_space.toml"
    one, two = (np.array(json_on(ranks, "solve", path)["bodies"][0]["force"]) for ranks in (1, 2))
    assert_allclose(two, one, atol=1e-9 * np.abs(one).max())
