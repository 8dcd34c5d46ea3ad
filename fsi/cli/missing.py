"""What a machine lacks, as one line with the remedy: libraries and a compiler that pip cannot install."""

import os
import re
import shutil
import sysconfig
from pathlib import Path

from fsi.errors import FsiError, InputError, SolveError

# As bootstrap.sh installs them: for gmsh and pictures, and for the forms that are compiled at run time.
LIBRARIES = "libgl1 libegl1 libglu1-mesa libxcursor1 libxft2 libxinerama1 libgomp1"
COMPILER = "gcc libc6-dev python3-dev"
SOLVER = {"dolfinx", "dolfinx_solver", "gmsh", "petsc4py", "mpi4py", "basix", "ffcx", "ufl"}

_LIBRARY = re.compile(r"(lib\S+\.so\S*): cannot open shared object file")


def explain(error: BaseException) -> FsiError | None:
    """What is missing on this machine where that is why the error came; None where it is not."""
    if isinstance(error, ModuleNotFoundError) and (error.name or "").partition(".")[0] in SOLVER:
        return InputError(
            f"{error.name} is not installed: resolved flows need the solver; "
            "pip install 'fsi-stokes[stokes]' (or the wheel with [stokes] after its name)"
        )
    library = _LIBRARY.search(str(error))
    if isinstance(error, OSError | ImportError) and library:
        return InputError(f"{library[1]} is missing on this machine; as root: apt-get install -y {LIBRARIES}")
    lacking = _lacking()
    if lacking and "ffcx" in _modules(error):
        return SolveError(
            f"{lacking} is missing on this machine, which compiles the forms; as root: "
            f"apt-get install -y {COMPILER}"
        )
    return None


def _lacking() -> str | None:
    """What FFCx does not find here."""
    if shutil.which(os.environ.get("CC", "gcc").split()[0]) is None:
        return "a C compiler"
    header = Path(sysconfig.get_path("include")) / "Python.h"
    return None if header.is_file() else "Python.h"


def _modules(error: BaseException) -> set[str]:
    """The top packages that the error has come through."""
    found, frame = set(), error.__traceback__
    while frame is not None:
        found.add(str(frame.tb_frame.f_globals.get("__name__", "")).partition(".")[0])
        frame = frame.tb_next
    return found
