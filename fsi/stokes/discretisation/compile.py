"""Compile forms at run time, and recover from a compilation that was killed half-way.

FFCx keeps what it compiles in a cache on disk. A process that was killed while compiling leaves an entry that
never gets ready; every later process waits for it in vain. After PATIENCE it is removed, and compiled anew.
"""

from __future__ import annotations

import re
from pathlib import Path

import ufl
from dolfinx import fem
from mpi4py import MPI

import fsi.parallel as parallel

PATIENCE = 60  # seconds; another process may be compiling the same form
_STALE = re.compile(r"remove (\S+\.c)\)")


# FFCx's own, and leave to reorder sums, which saves a quarter of the time of A; no machine's own code:
# machines may share a cache.
FLAGS = ["-O2", "-g0", "-fno-math-errno", "-fno-signed-zeros", "-fno-trapping-math", "-fassociative-math"]


def compile_form(form: ufl.Form) -> fem.forms.CompiledForm:
    """A compiled form, for all meshes of its kind; collective."""
    try:
        return _compile(form)
    except (TimeoutError, RuntimeError) as error:
        entry = _STALE.search(str(error))
        stale = MPI.COMM_WORLD.bcast(None if entry is None else entry[1])
        if stale is None:
            raise
        parallel.on_root(lambda: Path(stale).unlink(missing_ok=True))
        return _compile(form)


def _compile(form: ufl.Form) -> fem.forms.CompiledForm:
    return fem.compile_form(
        MPI.COMM_WORLD, form, jit_options={"timeout": PATIENCE, "cffi_extra_compile_args": FLAGS}
    )
