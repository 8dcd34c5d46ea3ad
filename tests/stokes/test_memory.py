"""What a solve frees the next one has again, memory stays flat over many steps, and ranks share it."""

import ctypes
import json
import math
import os
import platform
import resource
import subprocess
from pathlib import Path
from statistics import median

import numpy as np
import pytest

import fsi.parallel as parallel
from bench.space import SETTINGS, SMALL, sphere_case
from bench.step import forget_peak, peak_memory
from fsi.bodies.configuration import Configuration
from fsi.case.load import parse_case
from fsi.machine.heap import keep_freed
from fsi.stokes.model import StokesModel
from tests.ranks import needs_mpi, python_on

STEPS = {"always": 300, "when-needed": 500}
RISE = {"always": 0.9, "when-needed": 0.5}
# The heap grows until it has seen the largest meshes, for 100 steps where only some are meshed anew.
WARM, WINDOW = 100, 40
# Between medians over windows, which vary by 4 MB with their meshes, a single step by 8 MB. Known to leak
# where not freed: gmsh's model, 16 MB in all these steps, and PETSc's handles, 5.6 MB a step on two ranks.
ALLOWED = 6e6
# What two ranks take together over what one takes: 1.2 as measured, with ghosts, and 1.7 when the matrix was
# put together from a list of all its entries. The peak of the first, which meshes, over the second's: 1.05.
TOGETHER, FIRST = 1.4, 1.2


def pages_of(size: int) -> int:
    """How many pages the system must clear for a block of that size, which is filled and freed."""
    libc = ctypes.CDLL(None)
    libc.malloc.restype = ctypes.c_void_p
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    block = ctypes.c_void_p(libc.malloc(ctypes.c_size_t(size)))
    ctypes.memset(block, 1, size)
    libc.free(block)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="for glibc")
def test_a_freed_block_is_there_again() -> None:
    """Of 100 MB, as MUMPS has at two hundred discs; given back it would cost its 25 000 pages each time."""
    keep_freed()
    size = 100_000_000
    pages_of(size)
    assert pages_of(size) < 100


def resident() -> int:
    """Bytes of this process in memory (Linux)."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def memory_of_steps(folder: Path, remesh: str, steps: int) -> list[list[int]]:
    """Bytes after each step of a disc that rises and falls above a plane, by rank."""
    case = parse_case(
        {
            "name": "memory",
            "fluid": {"viscosity": 1.0},
            "domain": {"lower": [-4.0, 0.0], "upper": [4.0, 8.0]},
            "bodies": [{"name": "disc", "radius": 1.0, "position": [0.0, 2.0], "force": [0.0, -1.0]}],
            "discretisation": {"cells_per_circle": 16, "growth": 0.5},
            "time": {"end": 1.0, "remesh": remesh},
        }
    )
    model, start = StokesModel(case), case.configuration()
    memory = []
    for step in range(steps):
        rise = [[0.0, RISE[remesh] * math.sin(step)]]
        instant = model(Configuration(start.centres + rise, start.angles, start.radii), 0.0)
        instant.write(folder, 0)
        memory.append(resident())
    return parallel.gather(memory)


def peaks_of_sphere() -> None:
    """Print as JSON, on root, how many MB each rank takes before a solve in space, and at most during it."""
    case = sphere_case(SETTINGS["P2, 4 times"])
    small = sphere_case(SMALL)
    StokesModel(small)(small.configuration(), 0.0)
    forget_peak()
    before = peak_memory()
    StokesModel(case)(case.configuration(), 0.0)
    peaks = parallel.gather((before, peak_memory()))
    if parallel.is_root():
        print(json.dumps(peaks))  # noqa: T201


@pytest.mark.slow
@pytest.mark.mpi
@needs_mpi
def test_ranks_share_the_memory_of_a_solve_in_space() -> None:
    """Of 118030 unknowns: what is not libraries is shared out evenly, and little is there twice."""
    program = "from tests.stokes.test_memory import peaks_of_sphere; peaks_of_sphere()"
    taken = []
    for ranks in (1, 2):
        command = [*python_on(ranks), "-c", program]
        done = subprocess.run(command, check=True, timeout=900, capture_output=True, text=True)
        before, peak = np.array(json.loads(done.stdout)).T
        taken.append(float(sum(peak - before)))
    assert taken[1] < TOGETHER * taken[0]
    assert peak[0] < FIRST * peak[1]


def report(folder: str, remesh: str, steps: int) -> None:
    """Print `memory_of_steps` as JSON, on root."""
    memory = memory_of_steps(Path(folder), remesh, steps)
    if parallel.is_root():
        print(json.dumps(memory))  # noqa: T201


@pytest.mark.slow
@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("remesh", STEPS)
def test_memory_is_flat_after_the_first_steps(remesh: str, ranks: int, tmp_path: Path) -> None:
    """In processes of their own, where no memory that other tests gave back can hide a leak.

    A moved mesh is kept for some steps with all that solves on it share, and made anew now and then.
    """
    steps = STEPS[remesh]
    program = f"from tests.stokes.test_memory import report; report({str(tmp_path)!r}, {remesh!r}, {steps})"
    command = [*python_on(ranks), "-c", program]
    done = subprocess.run(command, check=True, timeout=900, capture_output=True, text=True)
    for memory in json.loads(done.stdout):
        assert len(memory) == steps
        assert median(memory[-WINDOW:]) - median(memory[WARM : WARM + WINDOW]) < ALLOWED
