"""What readers of a run find is what the finite element has, in serial and on ranks."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

import fsi
from tests.ranks import python_on

ROOT = Path(__file__).parents[2]
RANKS = [1, pytest.param(2, marks=pytest.mark.mpi)]
CASE = """
name = "two discs in a corner"
fluid.viscosity = 1.0
domain.lower = [-3.0, 0.0]
domain.upper = [3.0, 4.0]
[[bodies]]
name = "large"
radius = 1.0
position = [-1.2, 1.5]
force = [0.0, -20.0]
[[bodies]]
name = "small"
radius = 0.5
position = [0.5, 1.6]
angular_velocity = 1.0
[discretisation]
cells_per_circle = 12
growth = 0.6
[time]
end = 0.2
first_step = 0.05
tolerance = 1e-2
"""

type Ran = Callable[[int], Path]


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Ran:
    """Run folders by ranks, with the element's own values beside the files, each made once."""
    parent = tmp_path_factory.mktemp("runs")
    (parent / "case.toml").write_text(CASE)

    def folder(ranks: int) -> Path:
        path = parent / f"ranks_{ranks}"
        if not path.exists():
            program = ["-m", "tests.field_values", str(parent / "case.toml"), str(path)]
            subprocess.run([*python_on(ranks), *program], cwd=ROOT, check=True, timeout=900)
        return path

    return folder


@pytest.mark.parametrize("ranks", RANKS)
def test_nodal_velocities_are_the_elements_own_at_every_step(ranks: int, ran: Ran) -> None:
    """Single precision in the files would show as 1e-8."""
    run = fsi.open_run(ran(ranks))
    assert len(run.times) == len(run.steps) > 3
    assert run.steps["cells"].nunique() > 1  # it was remeshed
    for step in run.times.index:
        fluid = run.mesh(step)
        parts = [np.load(run.path / f"VALUES_{step}_{rank}.npz") for rank in range(ranks)]
        x, u = (np.concatenate([part[name] for part in parts]) for name in "xu")
        distance, node = cKDTree(fluid.points[:, :2]).query(x)
        assert distance.max() < 1e-13  # where ranks meet, they agree on a node to rounding
        assert len(np.unique(node)) == fluid.n_points
        np.testing.assert_allclose(fluid["velocity"][node, :2], u, rtol=0.0, atol=1e-12 * np.abs(u).max())


@pytest.mark.mpi
def test_ranks_give_the_same_rates(ran: Ran) -> None:
    """At step 0, where the meshes are the same; means over the cells of one rank would be off by percents."""
    serial, parallel = (fsi.open_run(ran(ranks)).mesh(0) for ranks in (1, 2))
    assert parallel.n_points == serial.n_points
    _, node = cKDTree(serial.points).query(parallel.points)
    for name in ("vorticity", "strain_rate", "pressure"):
        scale = np.abs(serial[name]).max()
        np.testing.assert_allclose(parallel[name], serial[name][node], rtol=0.0, atol=1e-9 * scale)


def test_strain_rates_are_those_of_the_dissipation(ran: Ran) -> None:
    """mu int strain_rate^2 against steps.csv: nodal means on these coarse meshes are good to 1.3e-3.

    It tells that they are rates of this flow, all of it; what they are is tested by `test_exact_fields`.
    """
    run = fsi.open_run(ran(1))
    fluid = run.mesh(0)
    fine = fluid.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=3)
    fine["density"] = fine["strain_rate"] ** 2
    assert fine.integrate_data()["density"][0] == pytest.approx(run.steps["dissipation"][0], rel=3e-3)
