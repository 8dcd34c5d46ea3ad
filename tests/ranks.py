"""The command line on several ranks."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

from tests.commands import fsi_command

MPIEXEC = Path(sys.executable).with_name("mpiexec")
needs_mpi = pytest.mark.skipif(not MPIEXEC.exists(), reason="no mpiexec beside this Python")


def python_on(ranks: int) -> list[str]:
    """What stands before the arguments of Python: on one rank no launcher."""
    return [*([] if ranks == 1 else [str(MPIEXEC), "-n", str(ranks)]), sys.executable]


def json_here(command: str, case: Path) -> Any:
    """The object that `fsi COMMAND CASE --json` prints in this process; one object and nothing else."""
    with redirect_stdout(StringIO()) as text:
        assert fsi_command(command, case, "--json") == 0
    return json.loads(text.getvalue())


def json_on(ranks: int, command: str, case: Path) -> Any:
    """The same on ranks; on one it needs no program of its own."""
    if ranks == 1:
        return json_here(command, case)
    full = [*python_on(ranks), "-m", "fsi", command, str(case), "--json"]
    done = subprocess.run(full, capture_output=True, text=True, timeout=900, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


EACH = """
import contextlib, io, json, sys
from fsi.cli.main import main
shown = []
for command, case in json.loads(sys.argv[1]):
    sys.argv[:] = ["fsi", command, case, "--json"]
    with contextlib.redirect_stdout(io.StringIO()) as text:
        if main() != 0:
            sys.exit(f"{command} {case} failed")
    shown.append(text.getvalue())
if all(shown):
    print(json.dumps([json.loads(text) for text in shown]))
"""


def json_of_each(ranks: int, commands: Sequence[tuple[str, Path]]) -> list[Any]:
    """The same of many commands, one after the other in one program, which takes as long to start as one."""
    if ranks == 1:
        return [json_here(command, case) for command, case in commands]
    given = json.dumps([(command, str(case)) for command, case in commands])
    full = [*python_on(ranks), "-c", EACH.strip(), given]
    done = subprocess.run(full, capture_output=True, text=True, timeout=900, check=False)
    assert done.returncode == 0, done.stderr
    found: list[Any] = json.loads(done.stdout)
    return found


def result_on(ranks: int, module: str, call: str) -> Any:
    """What an expression in the names of a module gives on rank 0, through JSON."""
    program = f"""from {module} import *
import json
from mpi4py import MPI
found = {call}
if MPI.COMM_WORLD.rank == 0:
    print(json.dumps(found))"""
    command = [*python_on(ranks), "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
