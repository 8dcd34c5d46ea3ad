"""Ranks that fail alone: all end, soon and with one message; nothing waits for ever."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

import pytest

import fsi.parallel as parallel
from bench.hangs import COMMANDS, Site, trial, trials
from fsi.errors import SolveError
from tests.ranks import python_on

# Two ranks; each scenario ends with an exchange that hangs if one rank does not come.
PROGRAM = """
import sys
from mpi4py import MPI
import fsi.parallel as parallel
from fsi.errors import SolveError

comm, rank, scenario = MPI.COMM_WORLD, parallel.rank(), sys.argv[1]
parallel.PATIENCE = 1.0

def fail():
    try:
        with parallel.together():
            if scenario == "same" or (scenario == "alone" and rank == 1):
                raise SolveError("the words")
            if scenario == "different":
                raise SolveError("the words") if rank == 0 else KeyError("the words")
            comm.barrier()
    finally:
        comm.barrier()  # a clean-up for which all ranks are needed

if scenario == "uncaught":
    if rank == 1:
        raise ValueError("the words")
elif scenario == "same":
    try:
        fail()
    except SolveError:
        comm.barrier()
        sys.exit(0)
else:
    fail()
comm.barrier()
"""


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("scenario", "code", "messages"),
    [("same", 0, 0), ("alone", 3, 1), ("different", 3, 1), ("uncaught", 1, 1)],
)
def test_an_error_goes_on_if_all_ranks_have_it_and_else_ends_them_all(
    scenario: str, code: int, messages: int
) -> None:
    """Without the command line, as the ranks of a Python user; the clean-up in the way needs all ranks."""
    command = [*python_on(2), "-c", PROGRAM, scenario]
    began = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert (done.returncode, done.stderr.count("Error: the words") + done.stderr.count("Error: 'the")) == (
        code,
        messages,
    ), done.stderr
    assert time.monotonic() - began < 60.0


@pytest.mark.parametrize(
    ("error", "code"),
    [(SystemExit(5), 5), (SystemExit(0), 1), (SystemExit("no"), 1), (SolveError("no"), 3), (ValueError(), 1)],
)
def test_the_exit_code_of_a_rank_that_ends_all_is_its_own(error: BaseException, code: int) -> None:
    """As Python leaves with it, `sys.exit(5)` with 5; 0 would say that what all did is done."""
    words, found = parallel._traceback(error)
    assert found == code
    assert type(error).__name__ in words


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("rank", "file", "name"),
    [
        (0, "stokes/identities.py", "Comm.Allreduce"),
        pytest.param(1, "stokes/solvers/mumps.py", "KSP.setUp", marks=pytest.mark.slow),
    ],
)
def test_an_error_on_one_rank_alone_ends_a_solve(rank: int, file: str, name: str, tmp_path: Path) -> None:
    """In the evaluation, behind clean-ups for which PETSc needs all ranks, and in the factorisation."""
    end = trial(COMMANDS["solve"], Site(file, None, name), rank, rank, tmp_path / "trial", 1.0)
    assert end.good, end


@pytest.mark.mpi
@pytest.mark.slow
def test_an_error_on_one_rank_alone_ends_every_command(tmp_path: Path) -> None:
    """At every call between ranks that any command passes, on either of two; half an hour."""
    ends = {(name, site, rank): end for name, site, rank, end in trials([*COMMANDS], [0, 1], 2.0, tmp_path)}
    assert {name for name, _, _ in ends} >= {"solve", "periodic", "run", "calibrate"}
    assert {at: end for at, end in ends.items() if not end.good} == {}
