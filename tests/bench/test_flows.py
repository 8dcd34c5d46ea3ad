"""Random cases that are solved once: what is counted, what fails, and that none is solved twice."""

from pathlib import Path

import pytest
import typer

from bench import flows
from bench.flows import Flow, main
from fsi.errors import SolveError
from fsi.meshes.errors import MeshError
from fsi.stokes.model import StokesModel


def test_cases_are_solved_and_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    keep = tmp_path / "kept"
    (first,) = flows.flows(["round container"], 1, 0, keep)
    assert first.unknowns > 100
    assert 0.0 < first.worst < 1e-8
    monkeypatch.setattr(Flow, "of", None)
    assert flows.flows(["round container"], 1, 0, keep) == [first]


def test_what_is_not_solved(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A mesh that is refused is no failure, a solve that fails is one."""
    errors = iter([MeshError("no room"), SolveError("violates the identity")])

    def fails(*_: object) -> None:
        raise next(errors)

    monkeypatch.setattr(StokesModel, "__call__", fails)
    main(["cell"], 1)
    with pytest.raises(typer.Exit):
        main(["cell"], 1)
    said = capsys.readouterr().out
    assert "refused: cell, 0: no room" in said
    assert "failed: cell, 0: violates the identity" in said


@pytest.mark.slow
def test_a_mesh_that_gmsh_cannot_make_is_made_with_finer_sizes() -> None:
    """gmsh splits edges of one side of this cell for a sphere that it cuts, and went on to a crash."""
    (found,) = flows.flows(["spheres in a cell"], 1, 78, None)
    assert not found.refused
    assert found.finer
    assert found.worst < 1e-8
