"""The one place that knows how dolfinx got here: import it before dolfinx, gmsh, petsc4py and mpi4py.

The PyPI wheel `dolfinx-solver-real` must be imported first, so that MPI is loaded before every
compiled module; conda-forge's `fenics-dolfinx` needs nothing.
"""

import importlib.util
import os

# Hosts that expose RDMA devices which they will not open make MPI print errors or stop.
os.environ.setdefault("UCX_TLS", "self,sm,tcp")
# Without /sys (bare containers) MPI's transports and hwloc complain on stderr, and work all the same.
os.environ.setdefault("UCX_LOG_LEVEL", "fatal")
os.environ.setdefault("HWLOC_HIDE_ERRORS", "2")

if importlib.util.find_spec("dolfinx_solver") is not None:
    importlib.import_module("dolfinx_solver")
