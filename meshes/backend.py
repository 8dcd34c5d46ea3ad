"""The one place that knows how dolfinx got here: import it before dolfinx, gmsh and petsc4py.

The PyPI wheel `dolfinx-solver-real` wants MPI loaded before what it brings, and refuses another PETSc beside
its own when `dolfinx_solver` is imported; conda-forge's `fenics-dolfinx` needs nothing. Only what meshes or
solves pays for it.
"""

import importlib.util
import sys
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from types import ModuleType
from typing import Any

from fsi.machine.signals import held
from fsi.meshes.mpi import load_mpi

# Another build of what the wheel brings. It reads the metadata of all installed packages to find them, which
# takes a twelfth of `fsi solve` of one disc: so it is asked only where there is one, to say what to do.
FOREIGN = ("petsc", "petsc4py", "slepc", "slepc4py", "dolfinx-solver-complex")


def _is_installed(name: str) -> bool:
    try:
        distribution(name)
    except PackageNotFoundError:
        return False
    return True


def _folder(name: str) -> str:
    """The folder that a package stands in; empty where it is not found."""
    found = importlib.util.find_spec(name)
    return "" if found is None or found.origin is None else found.origin.rpartition(f"{name}/")[0]


def _without_numba(name: str) -> ModuleType:
    """A module, loaded as if there were no Numba.

    DOLFINx and FFCx load it wherever it is installed, for kernels written with it, of which there are none
    here: that is an eighth of what `fsi solve` loads. So they do not find it; who wants it later does.
    """
    modules: dict[str, Any] = sys.modules
    if "numba" in modules:
        return importlib.import_module(name)
    modules["numba"] = None
    try:
        return importlib.import_module(name)
    finally:
        del modules["numba"]


@cache
def petsc_forms() -> ModuleType:
    """dolfinx.fem.petsc, which makes PETSc's matrices of forms; flows in the plane do without."""
    with held():
        return _without_numba("dolfinx.fem.petsc")


with held():
    load_mpi()
    _beside = _folder("dolfinx_solver")
    if _beside and (any(map(_is_installed, FOREIGN)) or _folder("petsc4py") != _beside):
        importlib.import_module("dolfinx_solver")
    _without_numba("dolfinx")
