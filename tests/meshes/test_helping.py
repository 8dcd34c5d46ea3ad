"""Other ranks take a share of what rank 0 does many times; no mesh depends on how many there are."""

from __future__ import annotations

from typing import Any

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
from mpi4py import MPI

from fsi.meshes.build import build
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.helping import help_root, helped, shared_out
from fsi.meshes.resolution import Resolution
from tests.ranks import needs_mpi, result_on


def root(x: float) -> float:
    if x < 0.0:
        raise MeshError("no root of {}", x)
    return float(np.sqrt(x))


def led(given: list[float]) -> list[float]:
    """Rank 0 does what is given with the others; collective."""
    if MPI.COMM_WORLD.rank > 0:
        help_root()
        return []
    with helped():
        twice = shared_out(root, given), shared_out(root, given[:1])
    return twice[0] + twice[1]


def failing() -> str:
    try:
        led([1.0, 4.0, -1.0])
    except MeshError as error:
        return str(error)
    return ""


def strips() -> tuple[int, float, float]:
    """A channel of 128 discs, which is meshed in two strips."""
    x, y = np.meshgrid(2.6 * np.arange(32) + 0.4, 2.7 * np.arange(4) + 1.4)
    wave = 0.1 * np.sin(np.arange(128))
    domain = FluidDomain(
        Box((0.0, 0.0), (83.2, 11.0), periodic=("x",)),
        np.column_stack([x.ravel(), y.ravel() + wave]),
        np.ones(128),
    )
    fluid = build(domain, Resolution(0.3, 12, 1.0, "sparse"), 2)
    mesh = fluid.mesh
    corners = mesh.geometry.x[mesh.geometry.dofmaps[0][: mesh.topology.index_map(2).size_local]]
    moment = MPI.COMM_WORLD.allreduce(float(np.square(corners).sum()))
    return fluid.cells(), fluid.quality, moment


def on_ranks(ranks: int, call: str) -> Any:
    """What a function of this module gives on rank 0."""
    return result_on(ranks, "tests.meshes.test_helping", call)


def test_alone_rank_0_does_all() -> None:
    assert led([4.0, 9.0, 16.0]) == [2.0, 3.0, 4.0, 2.0]
    assert failing() == "no root of -1"


@needs_mpi
@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [pytest.param(2, marks=pytest.mark.slow), 3])
def test_results_are_in_order_and_errors_raised(ranks: int) -> None:
    assert on_ranks(ranks, "led([4.0, 9.0, 16.0, 25.0])") == [2.0, 3.0, 4.0, 5.0, 2.0]
    assert on_ranks(ranks, "failing()") == "no root of -1"


@needs_mpi
@pytest.mark.mpi
def test_a_mesh_in_strips_is_the_same_on_two_ranks() -> None:
    cells, quality, moment = strips()
    assert on_ranks(2, "strips()") == [cells, quality, pytest.approx(moment, rel=1e-13)]
