"""The mesh of a step, back from its field files."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.meshes.errors import MeshFileError
from fsi.meshes.files.read import read_mesh
from fsi.meshes.geometry.container import FluidDomain
from fsi.postprocess.export import write_step_mesh
from fsi.postprocess.run.run import Run, open_run
from fsi.runs import run as run_case
from tests.flows import resting
from tests.ranks import needs_mpi, python_on

CASE: dict[str, Any] = {
    "name": "two discs",
    "fluid": {"viscosity": 1.0},
    "domain": {"lower": [-3.0, 0.0], "upper": [3.0, 5.0]},
    "bodies": [
        {"name": "large", "radius": 1.0, "position": [0.0, 1.3], "force": [0.0, -12.0]},
        {"name": "small", "radius": 0.5, "position": [1.0, 2.9], "force": [0.0, -2.0]},
    ],
    "discretisation": {"cells_per_circle": 20, "cells_per_gap": 0.5, "growth": 0.5},
    "time": {"end": 0.3, "remesh": "when-needed"},
}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    case = parse_case(CASE)
    folder = tmp_path_factory.mktemp("runs") / "run"
    run_case(case, folder)
    return folder


def test_the_mesh_of_a_step_gives_its_velocities_again(run: Path, tmp_path: Path) -> None:
    """A moved mesh, from VTU to .msh and back: velocities to 1e-12; a mesh made anew would differ by 1e-4."""
    from fsi.stokes.problem import StokesProblem
    from fsi.stokes.solve import solve

    case = parse_case(CASE)
    step = write_step_mesh(run, None, tmp_path / "step.msh")
    table = open_run(run).columns("steps")
    q = Run(run).configuration(step)
    container = case.container()
    fluid = read_mesh(tmp_path / "step.msh", case.names, FluidDomain(container, q.centres, q.radii), 3)
    U = solve(StokesProblem(fluid, container, q, case.motion(0.3), resting(container))).U
    bodies = open_run(run).columns("bodies")
    now = bodies["step"] == step
    assert step == table["step"][-1]
    np.testing.assert_allclose(U[:, 1], bodies["V_y"][now], rtol=1e-12)
    np.testing.assert_allclose(U[:, 2], bodies["omega"][now], atol=1e-12)


def test_what_cannot_be_written_says_so(run: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="step = 99: has no fields"):
        write_step_mesh(run, 99, tmp_path / "x.msh")
    with pytest.raises(MeshFileError, match="unknown suffix"):
        write_step_mesh(run, 0, tmp_path / "x.stl")
    with pytest.raises(InputError, match=r"there is no case\.toml"):
        write_step_mesh(tmp_path, 0, tmp_path / "x.msh")
    assert not list(tmp_path.iterdir())


def test_a_step_whose_file_is_lost_or_damaged(run: Path, tmp_path: Path) -> None:
    """`fsi resume` mends no field files, which a run does not need to go on."""
    copied = tmp_path / "run"
    shutil.copytree(run, copied)
    lost = copied / "fields" / "fluid_000000.vtu"
    lost.write_text("no grid")
    remedy = "; run the case again, or ask for another step"
    with pytest.raises(MeshFileError, match=rf"{lost.name}: cannot be read .*{remedy}"):
        write_step_mesh(copied, 0, tmp_path / "x.msh")
    lost.unlink()
    with pytest.raises(MeshFileError, match=rf"{lost.name}: is not there, or no file{remedy}"):
        write_step_mesh(copied, 0, tmp_path / "x.msh")


def on_two_ranks(folder: Path, output: Path) -> subprocess.CompletedProcess[str]:
    full = [*python_on(2), "-m", "fsi", "mesh", str(folder), "-o", str(output)]
    return subprocess.run(full, capture_output=True, text=True, timeout=300, check=False)


@needs_mpi
@pytest.mark.mpi
def test_two_ranks_write_what_one_writes(run: Path, tmp_path: Path) -> None:
    """PETSc starts on both, though root alone reads and writes."""
    one, two = tmp_path / "one.vtu", tmp_path / "two.vtu"
    step = write_step_mesh(run, None, one)
    done = on_two_ranks(run, two)
    assert (done.returncode, done.stdout) == (0, f"wrote {two}, step {step}\n"), done.stderr
    assert two.read_bytes() == one.read_bytes()


@needs_mpi
@pytest.mark.mpi
def test_two_ranks_refuse_a_run_without_a_mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of pores, in a box where both discs have room."""
    monkeypatch.setattr("fsi.pores.instant.FEW", 0)  # pressures in files take longer than all else
    box = {"domain": {"lower": [-3.0, 0.0], "upper": [3.0, 5.0]}, "time": {"end": 0.01, "tolerance": 1e-2}}
    given = {key: CASE[key] for key in ("name", "fluid", "bodies")} | box | {"model": "pores"}
    run_case(parse_case(given), tmp_path / "run")
    done = on_two_ranks(tmp_path / "run", tmp_path / "mesh.vtu")
    assert done.returncode == 2
    assert done.stderr.count('error: model = "pores": only the resolved level has a mesh') == 1
    assert not (tmp_path / "mesh.vtu").exists()
