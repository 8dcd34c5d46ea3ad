"""What commands load: libraries that take longer to load than the command needs are not among it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# A tenth of a second or more each: `python -X importtime -m fsi check CASE` says.
SLOW = {"scipy.stats", "scipy.optimize", "scipy.interpolate", "matplotlib", "pandas", "pyvista"}
SOLVER = {"dolfinx_solver", "dolfinx", "gmsh", "petsc4py", "ufl", "numba", "scipy.spatial", "scipy.sparse"}


def loaded(*command: str) -> set[str]:
    """The modules that a command has loaded in the end."""
    script = f"""
        import sys
        from fsi.cli.main import main
        sys.argv = ["fsi", *{command!r}]
        main()
        print("\\n", *sys.modules)
    """
    lines = "\n".join(line.strip() for line in script.splitlines())
    done = subprocess.run([sys.executable, "-c", lines], cwd=ROOT, capture_output=True, text=True, check=True)
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize(
    ("command", "not_needed"),
    [
        ("check", SLOW | SOLVER),
        ("solve", SLOW | {"fsi.pores.instant", "numba", "meshio", "scipy.spatial", "scipy.special"}),
    ],
    ids=["check", "solve"],
)
def test_a_command_loads_only_what_it_needs(command: str, not_needed: set[str]) -> None:
    found = loaded(command, "cases/disc_in_box.toml")
    assert {"numpy", "fsi.case.case"} <= found
    assert not found & not_needed
