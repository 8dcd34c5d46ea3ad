"""Solves on a moved mesh that keep patterns and MUMPS's analysis, against solves that begin anew."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.bodies.configuration import Configuration, Inertia, Motion
from fsi.meshes.build import FluidMesh, build
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.moving.move import Mover
from fsi.meshes.resolution import Resolution
from fsi.stokes.problem import Boundary, StokesProblem
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import solve
from fsi.stokes.solvers import reduced as kept
from fsi.stokes.solvers.mumps import Factorisation, Operator
from fsi.stokes.solvers.workspace import Workspace
from tests.flows import at_rest, discs, free, held
from tests.ranks import python_on

COARSE = Resolution(0.3, 16, 1.0)
CHANNEL = Box((0.0, -2.6), (5.0, 2.6), periodic=("x",))
BOX = Box((-2.0, -2.6), (4.0, 2.6))
Q = discs([(0.4, -1.3), (2.1, 0.2)], [1.0, 0.8])
LOADS = free((1.0, 0.5, 0.0), (0.0, -1.0, 0.3))
PATH = (0.0, 0.02, 0.05, -0.03)


def flow(
    fluid: FluidMesh,
    container: Container,
    q: Configuration,
    motion: Motion,
    workspace: Workspace | None,
    inertia: Inertia | None = None,
) -> StokesSolution:
    """Between walls at rest; open on the right where there is such a wall."""
    open_walls = {wall: 0.3 for wall in container.walls if wall == "right"}
    walls = {wall: at_rest for wall in container.walls if wall not in open_walls}
    problem = StokesProblem(fluid, container, q, motion, Boundary(walls, open_walls), inertia=inertia)
    return solve(problem, workspace=workspace)


@contextmanager
def moved(container: Container) -> Iterator[Iterator[tuple[FluidMesh, Configuration]]]:
    """One mesh along PATH, and the bodies."""
    mover = Mover(build(FluidDomain(container, Q.centres, Q.radii), COARSE, 3), Q.centres)

    def along() -> Iterator[tuple[FluidMesh, Configuration]]:
        for s in PATH:
            there = replace(Q, centres=Q.centres + s * np.array([[1.0, -0.5], [-1.0, 1.0]]))
            quality = mover.move(there.centres)
            assert quality is not None
            yield mover.fluid.moved(quality, container), there

    try:
        yield along()
    finally:
        mover.close()


def require_agreement(container: Container) -> None:
    """At every place on the path. Old factors would show at 1e-2, an old torque arm at 1e-3."""
    velocities = []
    with Workspace() as workspace, moved(container) as places:
        for fluid, q in places:
            one, other = (flow(fluid, container, q, LOADS, work) for work in (workspace, None))
            for name in ("U", "F", "traction_F", "dissipation"):
                a, b = np.asarray(getattr(one, name)), np.asarray(getattr(other, name))
                assert_allclose(a, b, rtol=0, atol=1e-10 * np.abs(b).max())
            velocities.append(one.U)
    assert np.abs(velocities[2] - velocities[0]).max() > 1e-3


@pytest.mark.parametrize("container", [CHANNEL, BOX], ids=["channel", "open box"])
def test_moved_steps_are_those_of_a_fresh_solve(container: Container) -> None:
    require_agreement(container)


@pytest.mark.mpi
def test_moved_steps_are_those_of_a_fresh_solve_on_two_ranks() -> None:
    program = "from tests.stokes.test_workspace import *; require_agreement(CHANNEL)"
    command = [*python_on(2), "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr


def test_what_fits_is_kept_and_what_does_not_begins_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """MUMPS analyses once for a mesh and its free modes, and again for others."""
    analysed = []

    def counted(matrix: object, dimension: int, operator: Operator) -> Factorisation:
        analysed.append(matrix)
        return Factorisation(matrix, dimension, operator)

    monkeypatch.setattr(kept, "Factorisation", counted)
    drawn = replace(LOADS, held=held((1.0, 0.0, 0.0), (0.0, 0.0, 0.0)).held)
    counts = []
    with Workspace() as workspace, moved(CHANNEL) as places:
        for (fluid, q), motion in zip(places, (LOADS, LOADS, drawn, drawn), strict=True):
            found = flow(fluid, CHANNEL, q, motion, workspace)
            counts.append(len(analysed))
            assert_allclose(found.U, flow(fluid, CHANNEL, q, motion, None).U, rtol=0, atol=1e-12)
            analysed[counts[-1] :] = []
        other = build(FluidDomain(CHANNEL, q.centres, q.radii), COARSE, 3)
        flow(other, CHANNEL, q, drawn, workspace)
        counts.append(len(analysed))
    assert counts == [1, 1, 2, 2, 3]


def test_bodies_with_inertia_are_not_those_without() -> None:
    """Groups of cells eliminate the velocities of those that have none; a body with inertia starts slower."""
    heavy = Inertia(np.array([[3.0, 3.0, 1.0], [0.0, 0.0, 0.0]]), np.zeros((2, 3)))
    fluid = build(FluidDomain(CHANNEL, Q.centres, Q.radii), COARSE, 3)
    drawn, speeds = free((1.0, 0.5, 0.0), (0.0, 0.0, 0.0)), []
    with Workspace() as workspace:
        for inertia in (None, heavy, None):
            one, other = (flow(fluid, CHANNEL, Q, drawn, work, inertia) for work in (workspace, None))
            assert_allclose(one.U, other.U, rtol=0, atol=1e-12)
            speeds.append(one.U[0, 0])
    assert speeds[1] < 0.9 * speeds[0]
