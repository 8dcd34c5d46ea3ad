"""The floors of the house: who may import whom, and what runs without DOLFINx, gmsh and MPI."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOLVER = ("fsi/stokes", "meshes")
FOLDERS = sorted(
    {
        str(path.parent.relative_to(ROOT))
        for top in ("fsi", "meshes", "postprocess")
        for path in (ROOT / top).rglob("*.py")
    }
)
LIGHT = [folder for folder in FOLDERS if not f"{folder}/".startswith(tuple(f"{top}/" for top in SOLVER))]
HEAVY = {"dolfinx", "dolfinx_solver", "gmsh", "petsc4py", "mpi4py", "basix", "ffcx", "ufl"}
# Hides the heavy packages as if they were not installed, then imports and uses the rest.
ABSENT = f"""
import importlib.machinery, sys

class Hiding(importlib.machinery.PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return None if name.partition(".")[0] in {HEAVY!r} else super().find_spec(name, path, target)

sys.meta_path = [Hiding if finder is importlib.machinery.PathFinder else finder for finder in sys.meta_path]
import importlib
for name in {{modules}}:
    importlib.import_module(name)
assert not {HEAVY!r} & set(sys.modules)
from fsi.cli.main import main
sys.argv = ["fsi", "check", "cases/disc_in_box.toml"]
main()
"""


def sources(*folders: str) -> Iterator[tuple[Path, set[str]]]:
    """Each file of the folders with the modules that it imports at its top level, not inside functions."""
    for folder in folders:
        for path in sorted((ROOT / folder).glob("*.py")):
            names: set[str] = set()
            for node in ast.parse(path.read_text()).body:
                if isinstance(node, ast.Import):
                    names |= {alias.name for alias in node.names}
                elif isinstance(node, ast.ImportFrom):
                    names.add(str(node.module))
            yield path, names


def begins(names: set[str], *packages: str) -> set[str]:
    return {name for name in names if any(f"{name}.".startswith(f"{package}.") for package in packages)}


def test_meshes_know_nothing_of_the_solver() -> None:
    found = {
        path.name: begins(names, "fsi") - begins(names, "fsi.meshes") for path, names in sources("meshes")
    }
    assert {name: bad for name, bad in found.items() if bad} == {}


def test_the_solver_knows_nothing_of_pictures() -> None:
    lower = [folder for folder in FOLDERS if folder.startswith("fsi/") and folder != "fsi/cli"]
    found = sources(*lower)
    assert {path.name: bad for path, names in found if (bad := begins(names, "fsi.postprocess"))} == {}


def test_heavy_packages_live_in_two_places() -> None:
    """Only fsi/stokes and meshes import them; `parallel` alone asks for MPI, where there is one."""
    found = sources(*LIGHT)
    bad = {path.name: names & HEAVY for path, names in found if names & HEAVY}
    assert bad == {}


def test_closed_forms_need_numpy_and_scipy_only() -> None:
    standard = set(sys.stdlib_module_names) | {"numpy", "scipy", "fsi"}
    for path, names in sources("fsi/lubrication"):
        assert {name.partition(".")[0] for name in names} <= standard, path.name
        assert not begins(names, "fsi.stokes", "fsi.case.case"), path.name


def test_what_is_not_resolved_runs_without_the_heavy_packages() -> None:
    """Import every module outside fsi/stokes and meshes, and check a case, with those packages hidden."""
    files = [path for folder in LIGHT for path in (ROOT / folder).glob("*.py")]
    modules = sorted(".".join(path.relative_to(ROOT).with_suffix("").parts) for path in files)
    modules = [name if name.startswith("fsi") else f"fsi.{name}" for name in modules]
    modules = [name for name in modules if not name.endswith(("__init__", "__main__", ".resolved"))]
    code = ABSENT.replace("{modules}", repr(modules))
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "disc" in done.stdout


@pytest.mark.parametrize("module", ["fsi.stokes.solve", "fsi.meshes.build"])
def test_hiding_really_hides(module: str) -> None:
    """The resolved model cannot be imported that way, or the test above would prove nothing."""
    done = subprocess.run(
        [sys.executable, "-c", ABSENT.replace("{modules}", repr([module]))],
        cwd=ROOT,
        capture_output=True,
        check=False,
    )
    assert done.returncode != 0
    assert b"ModuleNotFoundError" in done.stderr
