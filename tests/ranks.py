"""The command line on several ranks."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

MPIEXEC = Path(sys.executable).with_name("mpiexec")
needs_mpi = pytest.mark.skipif(not MPIEXEC.exists(), reason="no mpiexec beside this Python")


def python_on(ranks: int) -> list[str]:
    """What stands before the arguments of Python: on one rank no launcher."""
    return [*([] if ranks == 1 else [str(MPIEXEC), "-n", str(ranks)]), sys.executable]


def json_on(ranks: int, command: str, case: Path) -> Any:
    """The object that `fsi COMMAND CASE --json` prints; one object and nothing else."""
    full = [*python_on(ranks), "-m", "fsi", command, str(case), "--json"]
    done = subprocess.run(full, capture_output=True, text=True, timeout=900, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
