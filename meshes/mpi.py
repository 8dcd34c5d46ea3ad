"""The one place that loads MPI, at once in a process that something may have started as one of several.

Others do without until a mesh or a flow is wanted: to load it takes a tenth of `fsi check`. Then
`fsi.meshes.backend` loads it before dolfinx and gmsh: a library loaded before it may bring another copy, and
two of them in one process show as a hang or a wrong number.
"""

import importlib
import importlib.util
import os
from typing import Any

from fsi.errors import InputError
from fsi.machine.ranks import STARTED

# Hosts that expose RDMA devices which they will not open make MPI print errors or stop. For such devices
# alone UCX watches what memory is mapped, and patches the C library for it: 40 ms of each start.
if "UCX_TLS" not in os.environ:
    os.environ |= {"UCX_TLS": "self,sm,tcp", "UCX_MEM_MMAP_HOOK_MODE": "none"}
# Without /sys (bare containers) MPI's transports and hwloc complain on stderr, and work all the same.
os.environ.setdefault("UCX_LOG_LEVEL", "fatal")
os.environ.setdefault("HWLOC_HIDE_ERRORS", "2")


def load_mpi() -> Any:
    """mpi4py's MPI; None where it is absent. Raises InputError: one of several, none of which was told so."""
    if importlib.util.find_spec("mpi4py") is None:
        return None
    MPI = importlib.import_module("mpi4py.MPI")
    if MPI.COMM_WORLD.size > 1 and not STARTED:
        raise InputError("mpiexec sets no variable with PMI or RANK in its name; set one, RANKS=2, before it")
    return MPI
