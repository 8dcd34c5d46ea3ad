"""The mesh of a step of a run in space, back from its field files."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from fsi.case.load import parse_case
from fsi.postprocess.export import write_step_mesh
from fsi.postprocess.run.run import open_run
from fsi.runs import run as run_case

CASE = {
    "name": "a ball",
    "geometry": "spatial",
    "fluid": {"viscosity": 1.0},
    "domain": {"lower": [-3.0, -3.0, 0.0], "upper": [3.0, 3.0, 6.0]},
    "bodies": [{"name": "ball", "radius": 1.0, "position": [0.2, 0.0, 2.5], "force": [1.0, 0.0, -12.0]}],
    "discretisation": {"degree": 2, "cells_per_circle": 8, "growth": 1.0, "solver": "direct"},
    "time": {"end": 0.02, "first_step": 0.02, "tolerance": 0.1},
}


@pytest.mark.slow
def test_the_mesh_of_a_step_is_that_of_its_bodies(tmp_path: Path) -> None:
    """All cells, and the nodes of the group "ball" on the moved sphere, as curved cells have them."""
    case = parse_case(CASE)
    run_case(case, tmp_path / "run")
    step = write_step_mesh(tmp_path / "run", None, tmp_path / "step.msh")
    run, mesh = open_run(tmp_path / "run"), meshio.read(tmp_path / "step.msh")
    assert step == run.steps["step"].iloc[-1] > 0
    cells = sum(len(block) for block in mesh.cells if block.type == "tetra10")
    assert cells == run.steps["cells"].iloc[-1]
    group, dimension = mesh.field_data["ball"]
    assert dimension == 2
    tags = zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True)
    nodes = np.concatenate([b.data[tag == group].ravel() for b, tag in tags if b.type == "triangle6"])
    q = run.configuration(step)
    assert np.abs(q.centres[0] - case.bodies[0].position).max() > 1e-3
    away = np.linalg.norm(mesh.points[np.unique(nodes)] - q.centres[0], axis=1)
    assert len(away) > 50
    np.testing.assert_allclose(away, 1.0, atol=1e-9)
