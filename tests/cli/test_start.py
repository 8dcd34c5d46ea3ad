"""What commands load: libraries that take longer to load than the command needs are not among it."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace

import pytest

import fsi.meshes.mpi as mpi
from fsi.cli.loading import loading
from fsi.errors import InputError
from tests.scripts import ROOT, script

# A tenth of a second or more each: `python -X importtime -m fsi check CASE` says.
SLOW = {"scipy.stats", "scipy.optimize", "scipy.interpolate", "matplotlib", "pandas", "pyvista"}
SOLVER = {"mpi4py", "dolfinx_solver", "dolfinx", "gmsh", "petsc4py", "ufl"}
# Of what a flow in the plane does without, and of DOLFINx's wheel: what looks through all installed packages.
PARTS = {"numba", "scipy.spatial", "scipy.special", "scipy.sparse", "pycparser", "dolfinx_solver"}
OTHER = {
    "numba", "scipy", "importlib.metadata", "numpy.random", "fsi.arrangements.kinds", "fsi.cli.render",
    "fsi.integration.schemes", "fsi.observables.scales", "fsi.observables.truncation",
    "fsi.meshes.spatial.sizing",
}  # fmt: skip
# Of what the case of one disc has none: other shapes of bodies, walls and domains, laws of gaps, a motion,
# bodies that a file or grid gives.
NONE_OF_ONE_DISC = {
    "fsi.case.domains.cell", "fsi.case.domains.round", "fsi.case.arranged", "fsi.case.grids",
    "fsi.case.body_file",
    "fsi.case.shapes.ellipse", "fsi.case.profiles.wave", "fsi.lubrication.exact_results",
    "fsi.lubrication.below", "fsi.lubrication.named_laws", "fsi.integration.stepper",
    "fsi.meshes.spatial.tetrahedra", "fsi.case.force_laws.gravity",
}  # fmt: skip


def loaded(*command: str) -> set[str]:
    """The modules that a command has loaded in the end."""
    lines = f"""
        import sys
        from fsi.cli.main import main
        sys.argv = ["fsi", *{command!r}]
        main()
        print("\\n", *sys.modules)
    """
    done = script(lines)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize(
    ("command", "case", "not_needed"),
    [
        ("check", "disc_in_box", SLOW | SOLVER | OTHER | NONE_OF_ONE_DISC),
        ("check", "couette_N10", SLOW | SOLVER | OTHER | NONE_OF_ONE_DISC),
        ("solve", "disc_in_box", SLOW | PARTS | NONE_OF_ONE_DISC | {"fsi.pores.instant", "meshio"}),
        ("resistance", "disc_in_box", SLOW | {"fsi.reduced.model", "fsi.calibration.drag"}),
    ],
    ids=["check", "check of ten discs", "solve", "resistance"],
)
def test_a_command_loads_only_what_it_needs(command: str, case: str, not_needed: set[str]) -> None:
    found = loaded(command, f"cases/{case}.toml")
    assert {"numpy", "fsi.case.case"} <= found
    assert not found & not_needed


def test_what_is_loaded_is_not_looked_through_for_cycles() -> None:
    before = gc.get_freeze_count()
    try:
        with loading():
            assert not gc.isenabled()
            loaded_now: list[object] = [[] for _ in range(1000)]
        assert gc.isenabled()
        assert gc.get_freeze_count() - before >= len(loaded_now)
    finally:
        gc.unfreeze()


def test_ctrl_c_while_the_command_line_loads_is_one_line() -> None:
    """Python's traceback was printed, in the first half second."""
    lines = """
        import signal, sys
        signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored behind a shell's `&`
        class Interrupting:
            def find_spec(self, name, *_):
                if name == "fsi.cli.streams":
                    signal.raise_signal(signal.SIGINT)
        sys.meta_path.insert(0, Interrupting())
        import fsi.cli.main
    """
    done = script(lines)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "error: interrupted\n")


def test_ranks_that_nothing_told_so_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each would take itself for the only one, and write the same files."""
    two = SimpleNamespace(COMM_WORLD=SimpleNamespace(size=2))
    monkeypatch.setitem(sys.modules, "mpi4py.MPI", two)
    monkeypatch.setattr(mpi, "STARTED", True)
    assert mpi.load_mpi() is two
    monkeypatch.setattr(mpi, "STARTED", False)
    with pytest.raises(InputError, match="set one, RANKS=2"):
        mpi.load_mpi()


@pytest.mark.skipif(find_spec("dolfinx_solver") is None, reason="only the wheel brings a PETSc of its own")
def test_another_petsc_is_refused_by_the_wheel(tmp_path: Path) -> None:
    """Its own look through all packages is left out where none of these names is installed."""
    metadata = tmp_path / "petsc-3.0.dist-info" / "METADATA"
    metadata.parent.mkdir()
    metadata.write_text("Metadata-Version: 2.1\nName: petsc\nVersion: 3.0\n")
    environment = os.environ | {"PYTHONPATH": f"{ROOT}{os.pathsep}{tmp_path}"}
    done = subprocess.run(
        [sys.executable, "-c", "import fsi.meshes.backend"],
        cwd=ROOT, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert "ImportError: petsc is installed in this environment" in done.stderr
