"""What a machine lacks or refuses, as one line with the remedy: libraries, a compiler, room, permission."""

import errno
import os
import re
import shutil
import sysconfig
from collections.abc import Iterator
from pathlib import Path

from fsi.errors import FsiError, InputError, SolveError

# As bootstrap.sh installs them: for gmsh and pictures, and for the forms that are compiled at run time.
LIBRARIES = "libgl1 libegl1 libglu1-mesa libxcursor1 libxft2 libxinerama1 libgomp1"
COMPILER = "gcc libc6-dev python3-dev"
SOLVER = {"dolfinx", "dolfinx_solver", "gmsh", "petsc4py", "mpi4py", "basix", "ffcx", "ufl", "_cffi_backend"}

# What another path, or a right to it, puts right; the rest is the machine's (disk full, quota, input/output).
_OF_PATHS = (
    errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOENT, errno.EISDIR, errno.ENOTDIR, errno.ELOOP,
    errno.ENAMETOOLONG, errno.EEXIST, errno.ENOTEMPTY,
)  # fmt: skip

_LONGEST = 200  # letters of what a compiler says
_NO_ROOM = "failed to map segment"  # of a library, by the loader
_LIBRARY = re.compile(r"(lib\S+\.so\S*): cannot open shared object file")


def explain(error: BaseException) -> FsiError | None:
    """What this machine lacks or refuses where that is why the error came; None where it is not."""
    if isinstance(error, ModuleNotFoundError) and (error.name or "").partition(".")[0] in SOLVER:
        return InputError(
            f"{error.name} is not installed: resolved flows need the solver; "
            "pip install 'fsi-stokes[stokes]' (or the wheel with [stokes] after its name)"
        )
    library = _LIBRARY.search(str(error))
    if isinstance(error, OSError | ImportError) and library:
        return InputError(f"{library[1]} is missing on this machine; as root: apt-get install -y {LIBRARIES}")
    if isinstance(error, MemoryError) or any(_NO_ROOM in str(one) for one in _chain(error)):
        return SolveError("memory: there is not enough on this machine; give a coarser mesh or fewer bodies")
    lacking = _lacking()
    if lacking and "ffcx" in _modules(error):
        return SolveError(
            f"{lacking} is missing on this machine, which compiles the forms; as root: "
            f"apt-get install -y {COMPILER}"
        )
    if "ffcx" in _modules(error) or "JIT compilation" in str(error):
        compiler = os.environ.get("CC", "gcc")
        return SolveError(
            f"the compiler {compiler} failed on the forms ({_last_line(error)}); see that it compiles C, or "
            "name another one by the variable CC"
        )
    if isinstance(error, OSError) and error.strerror:
        return _refused(error)
    return None


def _chain(error: BaseException | None) -> Iterator[BaseException]:
    """The error, and those that it was raised for."""
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__


def _last_line(error: BaseException) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[-1][:_LONGEST]


def _refused(error: OSError) -> FsiError:
    """What the operating system does not let us do."""
    paths = " and ".join(str(path) for path in (error.filename, error.filename2) if path is not None)
    if error.errno in _OF_PATHS:
        return InputError(f"{paths or 'a file'}: {error.strerror}; give a path that can be read and written")
    where = paths or "standard output or a file"
    return SolveError(f"{where}: {error.strerror}; make room or give another place, and repeat the command")


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
