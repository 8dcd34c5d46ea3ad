"""What is read from the fields of a run whose mesh has narrow gaps opened, as laws stand for them."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from fsi.case.load import parse_case
from fsi.postprocess.export import write_step_mesh
from fsi.postprocess.render.planar import PlanarArtist
from fsi.postprocess.render.scenes import gap_at, scene, window_on
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.probe import probe
from fsi.postprocess.run.run import Run, open_run
from fsi.runs import run as run_case

ALONG = np.array([0.6, 0.8])
# A pair 0.02 apart across the upper side of the cell.
CASE = {
    "name": "a pair",
    "fluid": {"viscosity": 1.0},
    "domain": {"shape": "cell", "vectors": [[4.0, 0.0], [1.0, 3.8]], "shear": 1.0},
    "bodies": [
        {"name": "a", "radius": 1.0, "position": [1.5, 2.6]},
        {"name": "b", "radius": 0.6, "position": [1.5 + 1.62 * 0.6 - 1.0, 2.6 + 1.62 * 0.8 - 3.8]},
    ],
    "lubrication": {"below": 0.05},
    "discretisation": {"degree": 2, "cells_per_circle": 12, "growth": 1.0},
    "time": {"end": 0.01, "first_step": 0.01},
}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("runs") / "run"
    run_case(parse_case(CASE), folder)
    return open_run(folder)


def test_the_mesh_of_a_step_has_the_bodies_apart(run: Run, tmp_path: Path) -> None:
    """Its groups are on circles around where they are meshed, 0.05 apart; those of bodies are 0.02 apart."""
    step = write_step_mesh(run.path, None, tmp_path / "step.msh")
    mesh, q = meshio.read(tmp_path / "step.msh"), run.meshed(step)
    moved = np.linalg.norm(q.centres - run.configuration(step).centres, axis=1)
    np.testing.assert_allclose(moved, 0.015, atol=1e-3)  # half of 0.05 - 0.02 each
    for name, centre, radius in zip("ab", q.centres, q.radii, strict=True):
        group, _ = mesh.field_data[name]
        tags = zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True)
        nodes = np.concatenate([b.data[tag == group].ravel() for b, tag in tags if b.type == "line3"])
        away = mesh.points[np.unique(nodes), :2] - centre
        lattice = run.container(step).periods
        away -= np.rint(away @ np.linalg.inv(lattice)) @ lattice
        np.testing.assert_allclose(np.linalg.norm(away, axis=1), radius, atol=1e-9)


def test_a_point_is_in_the_body_that_the_mesh_has_there(run: Run) -> None:
    """Just within disc a, towards b, the mesh has fluid, and just beyond its other side none."""
    a = run.configuration(0).centres[0]
    table = probe(run, np.stack([a + 0.99 * ALONG, a - 1.01 * ALONG]), 0)
    assert table["where"].tolist() == ["fluid", "a"]


def test_a_close_up_is_of_the_gap_in_the_mesh_and_tells_the_true_one(run: Run) -> None:
    window = window_on(run, [0], run.mesh(0))
    gap = gap_at(run, 0, None, window)
    assert gap.width == pytest.approx(0.05, rel=1e-6)
    np.testing.assert_allclose(np.abs(gap.normal @ ALONG), 1.0, rtol=1e-9)
    title = PlanarArtist(run, Choice()).gap_title(0, gap, window)
    assert title == "narrowest gap, 0.02, meshed as 0.05"
    one, other = scene(run, 0, run.mesh(0), window.close_up(gap), tractions=True).q.centres
    assert np.linalg.norm(one - other) - 1.6 == pytest.approx(0.05, rel=1e-6)
