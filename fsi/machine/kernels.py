"""Which kernels OpenBLAS multiplies with: those of this processor, also where a library is older than it.

NumPy, SciPy, PETSc and CVXOPT bring an OpenBLAS each, and each asks who made the processor. That of CVXOPT,
of 2021, does not know those made since, and takes kernels of 2007: Cholesky's factors take twice as long.
"""

import os
from pathlib import Path

_CPUS = Path("/proc/cpuinfo")  # of Linux
# What kernels need of a processor, best first, by OpenBLAS's names.
_KERNELS = {
    "SkylakeX": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
    "Haswell": {"avx2", "fma"},
}


def kernels(cpus: str) -> str | None:
    """The best ones that the flags of a processor allow, in a text as of /proc/cpuinfo; None: unknown."""
    lines = (line.partition(":") for line in cpus.splitlines())
    flags = next((set(value.split()) for key, _, value in lines if key.strip() == "flags"), set[str]())
    return next((name for name, needed in _KERNELS.items() if needed <= flags), None)


def choose() -> None:
    """Tell libraries that are loaded from now on, unless the user does."""
    if "OPENBLAS_CORETYPE" not in os.environ and _CPUS.is_file():
        with _CPUS.open() as file:
            chosen = kernels(file.read(10_000))  # the first processor
        if chosen is not None:
            os.environ["OPENBLAS_CORETYPE"] = chosen


choose()
