"""What a step frees the next one has again."""

import platform
import resource
import subprocess
import sys

import pytest

from bench.pore_speed import timed


def pages_of_a_step() -> int:
    """How many pages the system must clear for one of 800 discs."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    timed(800, 1)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


@pytest.mark.slow
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="for glibc")
def test_a_step_has_the_memory_of_those_before() -> None:
    """In a process of its own, where no other test has had memory kept; without, it clears 24,000 pages."""
    program = "from tests.pores.test_memory import pages_of_a_step as pages; pages(), pages(); print(pages())"
    done = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True)
    assert int(done.stdout) < 4000  # 3 on a quiet machine, beside other work 1400
