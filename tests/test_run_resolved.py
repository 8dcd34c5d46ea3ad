"""Runs of the resolved model by the command line: killed and resumed, on ranks, read back, with inertia."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.spatial import cKDTree

from fsi.api import solve
from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.meshes.errors import MeshFileError
from fsi.meshes.files.write import write_mesh
from fsi.postprocess.run.run import open_run
from fsi.runs import run as run_case
from fsi.stokes.meshes import CaseMeshes
from fsi.stokes.model import StokesModel
from tests.ranks import python_on
from tests.small_run import contents, launches

ROOT = Path(__file__).parents[1]
CASE = """
name = "two discs fall"
[fluid]
viscosity = 1.0
[domain]
lower = [-4.0, 0.0]
upper = [4.0, 6.0]
[[bodies]]
name = "large"
radius = 1.0
position = [-1.2, 2.0]
force = [0.0, -40.0]
[[bodies]]
name = "small"
radius = 0.5
position = [0.7, 3.0]
force = [0.0, { times = [0.0, 0.5, 1.0], values = [-20.0, -20.0, 20.0] }]
torque = 5.0
[discretisation]
cells_per_circle = 16
growth = 0.5
[time]
end = 1.0
tolerance = 1e-3
"""


def fsi(*arguments: object, ranks: int = 1) -> list[str]:
    """The command line, on one or more ranks."""
    return [*python_on(ranks), "-m", "fsi", *map(str, arguments)]


def call(*arguments: object, ranks: int = 1) -> str:
    """What the command prints."""
    done = subprocess.run(
        fsi(*arguments, ranks=ranks), cwd=ROOT, check=True, timeout=900, capture_output=True, text=True
    )
    return done.stdout


@pytest.fixture(scope="module")
def case_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("case") / "case.toml"
    path.write_text(CASE)
    return path


def running(case_file: Path, folder: Path, remesh: str) -> list[object]:
    return ["run", case_file, "--output", folder, "--set", f'time.remesh="{remesh}"']


@pytest.fixture(scope="module")
def unbroken(case_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, int], Path]:
    """Folders of finished runs, by remesh and ranks, each made once."""
    parent = tmp_path_factory.mktemp("runs")

    def finished(remesh: str, ranks: int = 1) -> Path:
        folder = parent / f"{remesh}_{ranks}"
        if not folder.exists():
            call(*running(case_file, folder, remesh), ranks=ranks)
        return folder

    return finished


def kill_after(command: list[str], table: Path, rows: int) -> None:
    """Start a command, and end it with signal 9 once the table has that many rows."""
    process = subprocess.Popen(command, cwd=ROOT)
    deadline = time.monotonic() + 900.0
    while not table.exists() or table.read_bytes().count(b"\n") <= rows:
        assert process.poll() is None, "the run ended before it could be killed"
        assert time.monotonic() < deadline
        time.sleep(0.002)
    process.kill()
    process.wait()


@pytest.mark.parametrize("remesh", [pytest.param("always", marks=pytest.mark.slow), "when-needed"])
def test_killed_and_resumed_equals_unbroken(
    remesh: str, case_file: Path, unbroken: Callable[..., Path], tmp_path: Path
) -> None:
    """Bit by bit: tables (but for CPU seconds), fields, series, state."""
    expected = contents(unbroken(remesh))
    folder = tmp_path / "run"
    rows = int(np.random.default_rng().integers(1, len(expected["steps.csv"]) - 2))
    kill_after(fsi(*running(case_file, folder, remesh)), folder / "steps.csv", rows)
    call("resume", folder)
    assert contents(folder) == expected
    assert len(launches(folder)) == 2


def test_when_needed_moves_the_mesh_and_remeshes(unbroken: Callable[..., Path]) -> None:
    """Both must happen in the runs above; two different meshes hardly ever have the same number of cells."""
    cells = open_run(unbroken("when-needed")).columns("steps")["cells"]
    assert np.any(np.diff(cells) == 0.0)
    assert np.any(np.diff(cells) != 0.0)


@pytest.mark.mpi
@pytest.mark.parametrize("remesh", [pytest.param("always", marks=pytest.mark.slow), "when-needed"])
def test_two_ranks_take_the_same_way(remesh: str, unbroken: Callable[..., Path]) -> None:
    """To the error of these coarse meshes: a last bit of difference can make gmsh choose another triangle."""
    serial, parallel = (open_run(unbroken(remesh, ranks)).columns("bodies") for ranks in (1, 2))
    np.testing.assert_array_equal(parallel["step"], serial["step"])
    for column in ("t", "x", "y", "angle"):
        np.testing.assert_allclose(parallel[column], serial[column], atol=1e-5)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.mpi)])
def test_the_series_has_the_rigid_motions_at_the_discs(ranks: int, unbroken: Callable[..., Path]) -> None:
    """One file for each step and rank, read as one time series."""
    folder = unbroken("when-needed", ranks)
    run = open_run(folder)
    table = open_run(folder).columns("bodies")
    times = np.unique(table["t"])
    assert pv.PVDReader(str(folder / "fluid.pvd")).time_values == times.tolist()
    for t in times:
        now = table["t"] == t
        V, omega, q = (
            np.column_stack([table[name][now] for name in names])
            for names in (("V_x", "V_y"), ("omega",), ("x", "y"))
        )
        fluid = run.mesh(run.nearest(t))
        surface, body = on_surfaces(folder, t)
        distance, node = cKDTree(fluid.points[:, :2]).query(surface)
        assert distance.max() == 0.0
        r = surface - q[body]
        rigid = V[body] + omega[body] * np.column_stack([-r[:, 1], r[:, 0]])
        np.testing.assert_allclose(fluid["velocity"][node, :2], rigid, rtol=0.0, atol=1e-12 * np.abs(V).max())


def on_surfaces(folder: Path, t: float) -> tuple[Array, NDArray[np.intp]]:
    """Nodes of the surface series at a time (n, 2), and the body of each."""
    reader = pv.PVDReader(str(folder / "surface.pvd"))
    reader.set_active_time_value(t)
    surface = pv.merge(list(reader.read()))
    body = np.empty(surface.n_points, dtype=int)
    nodes = surface.cell_connectivity.reshape(surface.n_cells, -1)
    body[nodes] = surface.cell_data["body"][:, None]
    return surface.points[:, :2], body


def test_with_inertia_discs_approach_their_quasi_static_velocities(case_file: Path, tmp_path: Path) -> None:
    """From rest. Walls slow the discs down, and inertia answers late, by (m / R) dV/dt: 0.5 % here."""
    settings = ["time.end=0.3", "time.first_step=0.002", "output.fields=false"]
    for body in ("bodies.0", "bodies.1"):
        settings += [f"{body}.mass=0.2", f"{body}.moment_of_inertia=0.1"]
    folder = tmp_path / "run"
    call("run", case_file, "-o", folder, *(word for setting in settings for word in ("--set", setting)))
    table, case = open_run(folder).columns("bodies"), load_case(folder / "case.toml")
    V = table["V_y"].reshape(-1, 2)
    centres = np.column_stack([table["x"], table["y"]]).reshape(-1, 2, 2)
    q = Configuration(centres[-1], np.zeros(2), case.configuration().radii)
    quasi_static = StokesModel(case)(q, 0.3).U[:, 1]
    np.testing.assert_allclose(V[0], 0.0, atol=1e-6)
    # M dU/dt = F - R U: where they begin, U = (1 - exp(-t M^-1 R)) R^-1 F.
    t = table["t"].reshape(-1, 2)[1, 0]
    R, M = solve(case).resistance().R, np.diag([0.2, 0.2, 0.1] * 2)
    at_last = np.linalg.solve(R, [0.0, -40.0, 0.0, 0.0, -20.0, 5.0])
    U = at_last - expm(-t * np.linalg.solve(M, R)) @ at_last
    # Half or twice a mass or the step would be off by 40 % and more, each disc by itself by 2 to 4 %.
    np.testing.assert_allclose(V[1], U[1::3], rtol=0.01)
    np.testing.assert_allclose(V[-1], quasi_static, rtol=0.01)


@pytest.mark.slow
def test_pushed_then_pulled_comes_back(tmp_path: Path) -> None:
    """The row that the case expects; half-way the disc is 0.415 nearer."""
    settings = ["discretisation.cells_per_circle=24", "discretisation.growth=0.5", "output.fields=false"]
    options = [word for setting in settings for word in ("--set", setting)]
    call("run", ROOT / "cases" / "pushed_then_pulled.toml", "-o", tmp_path / "run", *options)
    expected = load_case(tmp_path / "run" / "case.toml").expected[0]
    y = open_run(tmp_path / "run").columns("bodies")["y"]
    assert y.min() == pytest.approx(1.585, abs=1e-3)
    assert y[-1] == pytest.approx(expected.value, rel=expected.rtol)


def test_a_refused_run_leaves_nothing_behind(tmp_path: Path) -> None:
    """A mesh of the user's own serves one place of the bodies; one that does not fit is seen at the start."""
    coarse = ["discretisation.cells_per_circle=12", "discretisation.growth=1.0", "discretisation.degree=2"]
    box, out = ROOT / "cases" / "disc_in_box.toml", tmp_path / "run"
    case = load_case(box, coarse)
    write_mesh(CaseMeshes(case).mesh(case.configuration()), tmp_path / "mine.msh", case.names)
    own = [*coarse, f'domain.mesh="{tmp_path}/mine.msh"', "time={end=1.0}"]
    with pytest.raises(InputError, match=r"domain\.mesh = .*bodies\.0\.velocity\.1 lets 'disc' move; drop"):
        run_case(load_case(box, own), out)
    assert not out.exists()
    at_rest = [*own, "bodies.0.velocity=[0.0,0.0]", "bodies.0.angular_velocity=1.0"]
    with pytest.raises(MeshFileError, match=r"disc lies up to 0\.1 off its place"):
        run_case(load_case(box, [*at_rest, "bodies.0.position=[0.0,1.2]"]), out)
    assert list(tmp_path.iterdir()) == [tmp_path / "mine.msh"]
    run_case(load_case(box, at_rest), out)
    assert (out / "state.npz").exists()
