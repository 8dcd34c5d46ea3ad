"""The one place that knows how dolfinx got here: import it before dolfinx, gmsh and petsc4py.

The PyPI wheel `dolfinx-solver-real` must be imported before what it brings, and looks through all installed
packages for a PETSc that would shadow its own; conda-forge's `fenics-dolfinx` needs nothing. So only what
meshes or solves pays for it.
"""

import importlib.util
import sys
from typing import Any

from fsi.meshes.mpi import load_mpi

load_mpi()
if importlib.util.find_spec("dolfinx_solver") is not None:
    importlib.import_module("dolfinx_solver")

# DOLFINx and FFCx load Numba wherever it is installed, for kernels written with it, of which there are none
# here: that is an eighth of what `fsi solve` loads. So they do not find it; who wants it later does.
_modules: dict[str, Any] = sys.modules
if "numba" not in _modules:
    _modules["numba"] = None
    try:
        importlib.import_module("dolfinx.fem.petsc")
    finally:
        del _modules["numba"]
