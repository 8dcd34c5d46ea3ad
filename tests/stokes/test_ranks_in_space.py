"""Ranks agree in space, by factors and by iterations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.stokes.resistance import case_resistance
from tests.ranks import json_on, needs_mpi, result_on
from tests.stokes.spatial_flows import BOX, case, solved

# Two spheres at opposite ends of a long box.
APART = BOX | {
    "domain": {"lower": [-2.0, -2.0, -9.0], "upper": [2.0, 2.0, 9.0]},
    "bodies": [
        {"name": name, "radius": 1.0, "position": [0.0, 0.0, z],
         "velocity": [0.0, 0.0, -1.0], "angular_velocity": [0.0, 0.0, 0.0]}
        for name, z in (("low", -6.0), ("high", 6.0))
    ],
}  # fmt: skip


def resistance(solver: str) -> list[list[float]]:
    """Without bars, the finer flow of which takes several times as long as that of the case."""
    found: list[list[float]] = case_resistance(
        case(BOX, solver=solver, cells_per_circle=8, growth=1.0)
    ).R.tolist()
    return found


def forces_apart() -> list[list[float]]:
    """The same."""
    found: list[list[float]] = solved(
        case(APART, solver="iterative", cells_per_circle=7, growth=1.0)
    ).F.tolist()
    return found


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
def test_ranks_agree_in_space(solver: str, several: tuple[int, ...]) -> None:
    one = np.array(resistance(solver))
    for ranks in several:
        other = result_on(ranks, "tests.stokes.test_ranks_in_space", f"resistance({solver!r})")
        assert_allclose(other, one, atol=1e-9 * np.abs(one).max())


@pytest.mark.mpi
@needs_mpi
def test_ranks_agree_on_a_flow_by_iterations() -> None:
    """The matrix of two ranks is in parts; one of them has no cell that meets a body whose motion it has."""
    one, two = forces_apart(), result_on(2, "tests.stokes.test_ranks_in_space", "forces_apart()")
    assert_allclose(two, one, atol=1e-9 * np.abs(one).max())


@pytest.mark.slow
@pytest.mark.mpi
@needs_mpi
def test_ranks_agree_on_the_default_sphere() -> None:
    """On two ranks factors of its coarsest matrix take a third more workspace than MUMPS reckons with."""
    path = Path(__file__).parents[2] / "cases" / "validation" / "sphere_in_space.toml"
    one, two = (np.array(json_on(ranks, "solve", path)["bodies"][0]["force"]) for ranks in (1, 2))
    assert_allclose(two, one, atol=1e-9 * np.abs(one).max())
