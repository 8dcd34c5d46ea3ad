"""Values of a solution at any point: the element's own, whatever the ranks, across periods."""

from __future__ import annotations

import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fsi.parallel as parallel
from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.load import parse_case
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.round import Round
from fsi.meshes.resolution import Resolution
from fsi.stokes.model import StokesModel
from fsi.stokes.problem import SolverOptions, StokesProblem
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import solve
from tests.flows import discs, held, mesh, resting, solved
from tests.periodic import force_free, in_cell, in_channel
from tests.ranks import python_on

R, OMEGA = 2.5, 0.8
CHANNEL = Box((-4.0, -1.0), (4.0, 1.0), periodic=("x",))
SPECK = discs([(3.9, 0.2)], [0.01])


@cache
def turning() -> StokesSolution:
    """A disc that turns in the middle of a round container."""
    return solved(
        Round(R), discs([(0.0, 0.0)], [1.0]), held((0.0, 0.0, OMEGA)), resolution=Resolution(1.0, 48)
    )


def ring() -> Array:
    """A thousand points between the disc and the container."""
    rng = np.random.default_rng(7)
    r, theta = rng.uniform(1.0, R, 1000), rng.uniform(0.0, 2.0 * np.pi, 1000)
    return np.column_stack([r * np.cos(theta), r * np.sin(theta)])


def exact(x: Array) -> Array:
    """Taylor 1923: u_theta = C (R^2 / r - r)."""
    r2 = np.square(x).sum(axis=1)
    u: Array = OMEGA / (R**2 - 1.0) * (R**2 / r2 - 1.0)[:, None] * np.column_stack([-x[:, 1], x[:, 0]])
    return u


def test_random_points_have_the_exact_flow() -> None:
    """To the accuracy of P3 on these curved cells (9e-6); straight ones would put nodes 1e-3 away."""
    x = ring()
    u, p = turning().evaluate(x)
    assert_allclose(u, exact(x), rtol=0.0, atol=2e-5 * OMEGA)
    assert_allclose(p, 0.0, atol=2e-3)


def test_at_the_nodes_it_has_the_nodal_values() -> None:
    flow = turning()
    u, p = flow.evaluate(flow.flow.x[::7])
    assert_allclose(u, flow.flow.u[::7], rtol=0.0, atol=1e-12)
    assert_allclose(p, flow.flow.p[::7], rtol=0.0, atol=1e-11)


def test_points_outside_the_fluid_have_no_values() -> None:
    u, p = turning().evaluate(np.array([[0.5, 0.0], [1.0, 0.0], [2.0, 0.0], [R, 0.0], [2.6, 0.0]]))
    assert np.isnan(p).tolist() == np.isnan(u[:, 0]).tolist() == [True, False, False, False, True]
    assert u[1, 1] == pytest.approx(OMEGA, rel=1e-9)


def test_poiseuille_flow_is_known_in_every_period() -> None:
    """dp/dx = -2 of the flux 4/3 is found; a speck of 1e-2 half widths disturbs u = 1 - y^2 by 1e-4."""
    flow = in_channel(CHANNEL, SPECK, force_free(SPECK), None, 4.0 / 3.0)
    assert flow.mean_pressure_gradient == pytest.approx([-2.0, 0.0], abs=1e-3)
    x = np.array([[s, y] for s in (-21.0, -4.0, 0.0, 4.0, 21.0) for y in (-0.9, 0.0, 0.5)])
    u, p = flow.evaluate(x)
    assert_allclose(u, np.column_stack([1.0 - x[:, 1] ** 2, np.zeros(len(x))]), rtol=0.0, atol=1e-3)
    assert_allclose(np.diff(p), -2.0 * np.diff(x[:, 0]), rtol=0.0, atol=1e-2)


def test_a_sheared_cell_is_known_everywhere_but_in_its_discs() -> None:
    """On an oblique lattice, over nine cells: u(x + e) = u(x) + E e and p(x + e) = p(x)."""
    q = discs([(0.3, 0.1), (2.6, 1.4)], [0.9, 0.5])
    flow = in_cell(Cell(((4.0, 0.0), (1.0, 3.5)), ((0.0, 1.0), (0.0, 0.0))), q)
    lattice, rng = flow.problem.fluid.lattice, np.random.default_rng(3)
    x = rng.uniform(0.0, 1.0, (200, 2)) @ lattice.vectors
    to_images = (x[:, None] - q.centres)[:, :, None] - lattice.shift(lattice.near())
    in_disc = (np.linalg.norm(to_images, axis=3).min(axis=2) < q.radii).any(axis=1)
    u, p = flow.evaluate(x)
    assert np.array_equal(np.isnan(p), in_disc)
    assert 10 < in_disc.sum() < 150
    x, u, p = x[~in_disc], u[~in_disc], p[~in_disc]
    for e in lattice.shift(lattice.near()):
        u_there, p_there = flow.evaluate(x + e)
        assert_allclose(u_there - u, np.tile([e[1], 0.0], (len(x), 1)), rtol=0.0, atol=1e-9)
        assert_allclose(p_there, p, rtol=0.0, atol=1e-9 * np.abs(p).max())


def test_a_solution_keeps_its_flow_when_the_mesh_has_moved_on() -> None:
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 2.0], "force": [0.0, -1.0]}
    case = parse_case(
        {
            "name": "moved",
            "fluid": {"viscosity": 1.0},
            "domain": {"lower": [-4.0, 0.0], "upper": [4.0, 8.0]},
            "bodies": [body],
            "discretisation": {"cells_per_circle": 16, "growth": 0.5},
            "time": {"end": 1.0, "remesh": "when-needed"},
        }
    )
    model, q, x = StokesModel(case), case.configuration(), np.array([[1.2, 2.3], [-3.0, 5.0]])
    first = model(q, 0.0)
    u, _ = first.evaluate(x)
    second = model(Configuration(q.centres - [[0.0, 0.1]], q.angles, q.radii), 0.0)
    assert second.problem.fluid.mesh is first.problem.fluid.mesh
    assert np.array_equal(first.evaluate(x)[0], u)
    assert np.abs(second.evaluate(x)[0] - u).max() > 1e-4


@pytest.mark.parametrize(("degree", "around"), [(3, 14), pytest.param(4, 10, marks=pytest.mark.slow)])
def test_a_sphere_that_turns_in_a_ball(degree: int, around: int) -> None:
    """u = C (1 / r^3 - 1 / R^3) e_z x r to 1e-2, on tetrahedra half as long as the radius or longer."""
    ball, q = Round(R, dimension=3), Configuration.unturned(np.zeros((1, 3)), np.ones(1))
    problem = StokesProblem(
        mesh(ball, q, Resolution(0.5, around, 1.0), degree), ball, q, held((0, 0, 0, 0, 0, 1)), resting(ball)
    )
    flow = solve(problem, SolverOptions(degree, solver="direct"))
    rng = np.random.default_rng(5)
    r, direction = rng.uniform(1.0, R, 300), rng.normal(size=(300, 3))
    x = direction * (r / np.linalg.norm(direction, axis=1))[:, None]
    rate = (r**-3 - R**-3) / (1.0 - R**-3)
    u, p = flow.evaluate(x)
    assert_allclose(u, rate[:, None] * np.cross([0.0, 0.0, 1.0], x), rtol=0.0, atol=0.012)
    assert not np.isnan(p).any()
    assert_allclose(flow.evaluate(flow.flow.x[::7])[0], flow.flow.u[::7], rtol=0.0, atol=1e-12)


def require_values_of_one_rank(path: str) -> None:
    """All ranks have the values that one rank has kept there, to 1e-9."""
    u, _ = turning().evaluate(ring())
    for values in parallel.gather(u):
        assert np.array_equal(values, u)
    assert_allclose(u, np.load(path), rtol=0.0, atol=1e-9)


@pytest.mark.mpi
def test_ranks_have_the_values_of_one(tmp_path: Path) -> None:
    np.save(tmp_path / "u.npy", turning().evaluate(ring())[0])
    program = (
        f"from tests.stokes.test_evaluate import *; require_values_of_one_rank({str(tmp_path / 'u.npy')!r})"
    )
    command = [*python_on(3), "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
