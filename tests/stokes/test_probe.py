"""`probe` on resolved runs whose exact field is known."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import fsi
from fsi.case.load import parse_case
from fsi.postprocess.run.probe import probe
from fsi.postprocess.run.run import Run
from fsi.runs import run as run_case

A, R, OMEGA = 1.0, 2.5, 0.8


@pytest.fixture(scope="module")
def turning(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A disc that turns in the middle of a round container (Taylor 1923): u_theta = C (R^2 / r - r)."""
    disc = {"name": "disc", "radius": A, "position": [0.0, 0.0], "velocity": [0.0, 0.0]}
    case = parse_case(
        {
            "name": "turning disc",
            "fluid": {"viscosity": 1.3},
            "domain": {"shape": "round", "radius": R},
            "bodies": [disc | {"angular_velocity": OMEGA}],
            "discretisation": {"cells_per_circle": 48},
            "time": {"end": 0.1, "first_step": 0.1},
        }
    )
    folder = tmp_path_factory.mktemp("turning") / "run"
    run_case(case, folder)
    return fsi.open_run(folder)


def random_points() -> NDArray[np.float64]:
    """A thousand points between the disc and the container."""
    rng = np.random.default_rng(7)
    r, theta = rng.uniform(A, R, 1000), rng.uniform(0.0, 2.0 * np.pi, 1000)
    return np.column_stack([r * np.cos(theta), r * np.sin(theta)])


def test_random_points_have_the_exact_flow(turning: Run) -> None:
    """To the accuracy of P3 on these cells (9e-6); values read off a drawing are off by 7e-4."""
    x = random_points()
    table = probe(turning, x)
    assert set(table["where"]) == {"fluid"}
    r2 = np.square(x).sum(axis=1)
    C = OMEGA * A**2 / (R**2 - A**2)
    exact = C * (R**2 / r2 - 1.0)[:, None] * np.column_stack([-x[:, 1], x[:, 0]])
    np.testing.assert_allclose(table[["u_x", "u_y"]], exact, rtol=0.0, atol=2e-5 * OMEGA)
    np.testing.assert_allclose(table["vorticity"], -2.0 * C, rtol=0.0, atol=5e-3 * OMEGA)
    np.testing.assert_allclose(table["strain_rate"], 2.0 * C * R**2 / r2, rtol=0.0, atol=5e-3 * OMEGA)
    np.testing.assert_allclose(table["p"], 0.0, atol=2e-3)


def test_at_the_nodes_it_has_the_nodal_values(turning: Run) -> None:
    fluid = turning.mesh()
    nodes = fluid.points[::7]
    table = probe(turning, nodes[:, :2])
    np.testing.assert_allclose(table[["u_x", "u_y"]], fluid["velocity"][::7, :2], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(table["p"], fluid["pressure"][::7], rtol=0.0, atol=1e-11)


def test_points_outside_say_where_they_are(turning: Run) -> None:
    table = probe(turning, np.array([[0.5, 0.0], [A, 0.0], [2.0, 0.0], [R, 0.0], [2.6, 0.0]]))
    assert table["where"].tolist() == ["disc", "fluid", "fluid", "fluid", "outside"]
    assert table["u_y"][1] == pytest.approx(OMEGA * A, rel=1e-9)
    assert table.loc[[0, 4], "u_x":].isna().to_numpy().all()


def test_stokes_flow_past_spheres_has_a_hoop_strain(tmp_path: Path) -> None:
    """A sphere moving in the middle of a spherical container: the integral of mu strain_rate^2 is -F.V.

    By Gauss's rule in r and theta on points of the fluid; without the hoop strain it lacks 5 %.
    """
    motion = {"velocity": [0.0, 1.0], "angular_velocity": 0.0}
    case = parse_case(
        {
            "name": "ball",
            "geometry": "axisymmetric",
            "fluid": {"viscosity": 1.0},
            "domain": {"shape": "round", "radius": R},
            "bodies": [{"name": "ball", "radius": A, "position": [0.0, 0.0], **motion}],
            "discretisation": {"cells_per_circle": 24},
            "time": {"end": 1e-6, "first_step": 1e-6},
        }
    )
    run_case(case, tmp_path / "run")
    run = fsi.open_run(tmp_path / "run")
    nodes, weights = np.polynomial.legendre.leggauss(40)
    r, theta = (A + R + (R - A) * nodes) / 2.0, 0.5 * np.pi * (nodes + 1.0)
    w = np.outer(weights * (R - A) / 2.0 * r**2, weights * 0.5 * np.pi * np.sin(theta)) * 2.0 * np.pi
    x = np.stack([np.outer(r, np.sin(theta)), np.outer(r, np.cos(theta))], axis=-1).reshape(-1, 2)
    table = probe(run, x, step=0)
    dissipation = w.ravel() @ np.square(table["strain_rate"])
    assert dissipation == pytest.approx(run.steps["dissipation"][0], rel=2e-4)


CHANNEL: dict[str, Any] = {
    "domain": {"lower": [0.0, 0.0], "upper": [8.0, 5.0], "periodic": ["x"], "pressure_gradient": -1.3},
    "bodies": [
        {"name": "a", "radius": 1.0, "position": [4.0, 1.1]},
        {"name": "b", "radius": 1.0, "position": [6.0, 3.8]},
        {"name": "c", "radius": 0.5, "position": [7.9, 2.0]},
    ],
}
CELL: dict[str, Any] = {
    "domain": {"shape": "cell", "vectors": [[5.0, 0.0], [1.5, 4.0]], "shear": 1.0},
    "bodies": [
        {"name": "one", "radius": 1.0, "position": [1.6, 1.5], "force": [1.0, 0.5]},
        {"name": "ellipse", "position": [3.3, 2.2], "shape": {"kind": "ellipse", "axes": [0.9, 0.5]}},
    ],
}


@pytest.mark.parametrize("sections", [CHANNEL, CELL], ids=["channel", "cell"])
def test_a_periodic_flow_is_found_at_all_images(sections: dict[str, Any], tmp_path: Path) -> None:
    """As the solution has it, to rounding: with E e of the mean flow, and the pressure's G.e, in the cell of
    the force over its area, (1, 0.5)/20. Images of bodies have the names of these.
    """
    more = {"time": {"end": 1e-3, "first_step": 1e-3}, "discretisation": {"cells_per_circle": 12}}
    case = fsi.make_case(name="periodic", fluid={"viscosity": 1.0}, **more, **sections)
    solution, run = fsi.solve(case), fsi.run(case, tmp_path / "run")
    x = np.random.default_rng(0).uniform((-12.0, 0.0), (20.0, 5.0), (300, 2))
    table = probe(run, x, 0)
    u, p = solution.evaluate(x)
    fluid = (table["where"] == "fluid").to_numpy()
    np.testing.assert_array_equal(fluid, np.isfinite(p))
    np.testing.assert_allclose(table[["u_x", "u_y"]], u, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(table["p"], p, rtol=0.0, atol=1e-11)
    assert 0.7 < fluid.mean() < 0.9  # bodies have a sixth of the area, and a quarter
    e = case.container().periods.sum(axis=0)
    for name, centre in zip(case.names, case.configuration().centres, strict=True):
        assert set(probe(run, centre + np.outer([-2.0, 0.0, 1.0], e), 0)["where"]) == {name}
    with warnings.catch_warnings(action="error"):  # beyond 2^63 periods
        assert set(probe(run, np.array([[1e200, 2.5], [2.5, 1e200]]), 0)["where"]) == {"outside"}
