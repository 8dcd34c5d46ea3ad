"""OpenBLAS takes kernels that the processor has, also in libraries that do not know it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fsi.machine.kernels import kernels

AVX512 = "avx512f avx512dq avx512cd avx512bw avx512vl"


@pytest.mark.parametrize(
    ("flags", "chosen"),
    [
        (f"fpu sse2 avx avx2 fma {AVX512}", "SkylakeX"),
        ("fpu sse2 avx avx2 fma avx512f avx512cd", "Haswell"),  # of Knights Landing
        ("fpu sse2 avx avx2 fma", "Haswell"),
        ("fpu sse2 avx", None),
    ],
)
def test_kernels_are_those_that_the_flags_allow(flags: str, chosen: str | None) -> None:
    assert kernels(f"processor\t: 0\nmodel name\t: a name: avx2\nflags\t\t: {flags}\n") == chosen


def test_nothing_is_chosen_for_other_processors() -> None:
    assert kernels("processor\t: 0\nFeatures\t: fp asimd\n") is None


@pytest.mark.parametrize("given", [None, "Haswell"])
def test_cvxopt_takes_them_unless_the_user_says_otherwise(given: str | None) -> None:
    """By itself it took those of Barcelona, of 2007, on a processor of 2024."""
    best = kernels(Path("/proc/cpuinfo").read_text())
    if best is None:
        pytest.skip("a processor without AVX2")
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}
    environment |= {"OPENBLAS_VERBOSE": "2"} | ({} if given is None else {"OPENBLAS_CORETYPE": given})
    command = [sys.executable, "-c", "import fsi.pores.definite; from cvxopt import cholmod"]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=60)
    found = {line.partition(":")[2].strip() for line in ended.stderr.splitlines() if "Core:" in line}
    assert found == {given or best}
