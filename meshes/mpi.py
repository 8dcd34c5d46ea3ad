"""The one place that loads MPI: import it before any compiled module.

`MPI` is that of mpi4py, None where that is absent. A library loaded before it may bring another copy; two of
them in one process show as a hang or a wrong number.
"""

import importlib
import importlib.util
import os
from typing import Any

# Hosts that expose RDMA devices which they will not open make MPI print errors or stop.
os.environ.setdefault("UCX_TLS", "self,sm,tcp")
# Without /sys (bare containers) MPI's transports and hwloc complain on stderr, and work all the same.
os.environ.setdefault("UCX_LOG_LEVEL", "fatal")
os.environ.setdefault("HWLOC_HIDE_ERRORS", "2")

MPI: Any = importlib.import_module("mpi4py.MPI") if importlib.util.find_spec("mpi4py") is not None else None
