"""The floors of the house: who may import whom, and what runs without DOLFINx, gmsh and MPI."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest
from importlinter import cli

from tests.scripts import script

ROOT = Path(__file__).parents[1]
FOLDERS = ("fsi", "meshes", "postprocess")
SOLVER = ("fsi.stokes", "fsi.meshes")
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


def modules() -> dict[str, Path]:
    """Every module of the house with its file."""
    files = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py")]
    names = {path: ".".join(path.relative_to(ROOT).with_suffix("").parts) for path in files}
    return {name if name.startswith("fsi") else f"fsi.{name}": path for path, name in names.items()}


def test_imports_go_down_only(capsys: pytest.CaptureFixture[str]) -> None:
    """The contracts of pyproject.toml; imports inside functions and under TYPE_CHECKING count."""
    broken = cli.lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True)
    assert broken == cli.EXIT_STATUS_SUCCESS, capsys.readouterr().out


def test_an_import_that_runs_up_is_seen(tmp_path: Path) -> None:
    """Hidden in a function: what the contracts are for."""
    for name, text in (("low", "def f():\n    import house.high\n"), ("high", "import house.low\n")):
        (tmp_path / "house").mkdir(exist_ok=True)
        (tmp_path / "house" / f"{name}.py").write_text(text)
    (tmp_path / "house" / "__init__.py").touch()
    contract = "[importlinter:contract:1]\nname=x\ntype=layers\nlayers=\n    house.high\n    house.low\n"
    (tmp_path / ".importlinter").write_text(f"[importlinter]\nroot_package=house\n{contract}")
    program = [sys.executable, "-c", "from importlinter.cli import lint_imports_command as main; main()"]
    done = subprocess.run([*program, "--no-cache"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "house.low -> house.high" in done.stdout


def test_no_module_has_two_names() -> None:
    """`meshes` and `postprocess` at the top are imported as rooms of fsi alone."""
    files = [*modules().values(), *(ROOT / "tests").rglob("*.py"), *(ROOT / "bench").rglob("*.py")]
    imported = re.compile(r"^\s*(import|from)\b.*(?<![.\w])(meshes|postprocess)\b", re.MULTILINE)
    for path in files:
        if not imported.search(text := path.read_text()):
            continue  # to walk through all takes seconds
        for node in ast.walk(ast.parse(text)):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [str(node.module)] if isinstance(node, ast.ImportFrom) else []
            assert not {name.partition(".")[0] for name in names} & {"meshes", "postprocess"}, path


def test_closed_forms_need_numpy_and_scipy_only() -> None:
    standard = set(sys.stdlib_module_names) | {"numpy", "scipy", "fsi"}
    for path in (ROOT / "fsi" / "lubrication").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [str(node.module)] if isinstance(node, ast.ImportFrom) else []
            assert {name.partition(".")[0] for name in names} <= standard, path.name


def test_what_is_not_resolved_runs_without_the_heavy_packages() -> None:
    """Import every module outside fsi/stokes and meshes, and check a case, with those packages hidden."""
    light = [name for name in sorted(modules()) if not f"{name}.".startswith(tuple(f"{s}." for s in SOLVER))]
    of_resolved = ("validation.resolved", "validation.parts")
    light = [name for name in light if not name.endswith(("__init__", "__main__", *of_resolved))]
    code = ABSENT.replace("{modules}", repr(light))
    done = script(code)
    assert done.returncode == 0, done.stderr
    assert "disc" in done.stdout


@pytest.mark.parametrize("module", ["fsi.stokes.solve", "fsi.meshes.build"])
def test_hiding_really_hides(module: str) -> None:
    """The resolved model cannot be imported that way, or the test above would prove nothing."""
    done = script(ABSENT.replace("{modules}", repr([module])))
    assert done.returncode != 0
    assert "ModuleNotFoundError" in done.stderr
