"""Runs of one case at several levels: on several ranks root alone decides what is there."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.test_commands import ROOT, call
from tests.ranks import needs_mpi, python_on

LATE = """
import sys, time
from pathlib import Path
import fsi, fsi.parallel as parallel
from fsi.comparison.motion import run_levels

exists = Path.exists

def late(path, **more):
    if parallel.rank() == 1 and path.name == "reduced":
        time.sleep(1.0)
    return exists(path, **more)

Path.exists = late
case = fsi.load_case(sys.argv[1], ["model=reduced", "reduced.drag=10", "time.end=0.1"])
for _ in range(2):  # the second time the runs are there
    run_levels({"reduced": case}, Path(sys.argv[2]))
"""


@needs_mpi
@pytest.mark.mpi
def test_a_rank_that_looks_late_does_what_the_others_do(tmp_path: Path) -> None:
    """It saw the folder that root had made meanwhile, and took the run for one to go on with."""
    case = ROOT / "cases" / "settling_discs.toml"
    done = call(*python_on(2), "-c", LATE, str(case), str(tmp_path / "out"), timeout=120.0)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "reduced" / "state.npz").exists()
