"""Forms compiled at run time, and the cache on disk of what FFCx has compiled, which may be in any state.

A process that is killed while it compiles leaves an entry that never gets ready, for which every later one
would wait; a full disk or a power cut leaves a library cut short, whose use ends in a bus error. Entries are
therefore looked at before the first is used, and what is broken is removed and compiled again. Where there
can be no cache, a folder is used that lasts as long as the process.
"""

import hashlib
import importlib.util
import io
import os
import re
import struct
import sysconfig
import tempfile
import time
from contextlib import redirect_stdout
from functools import cache
from pathlib import Path
from typing import Any

import cffi
import dolfinx.jit
import ufl
from dolfinx import fem
from mpi4py import MPI

import fsi.parallel as parallel

PATIENCE = 60  # seconds; another process may be compiling the same form
_STALE = re.compile(r"remove (\S+\.c)\)")

# FFCx's own, and leave to reorder sums, several terms of which are then added at once; no machine's own code:
# machines may share a cache.
FLAGS = ["-O3", "-g0", "-fno-math-errno", "-fno-signed-zeros", "-fno-trapping-math", "-fassociative-math"]
UNROLLED = ["-freciprocal-math"]  # of loops over small matrices

_READY = "c.cached"
_ELF, _HEADER = b"\x7fELF\x02\x01", 64  # of a library of 64 bits on Linux


def compile_form(form: ufl.Form) -> fem.forms.CompiledForm:
    """A compiled form, for all meshes of its kind; collective."""
    try:
        return _compile(form)
    except (TimeoutError, RuntimeError, ImportError) as error:
        parallel.settle(error)
        source = MPI.COMM_WORLD.bcast(blocked_by(error, _folder()))
        if source is None:
            raise
        parallel.on_root(lambda: _remove(source))
        return _compile(form)


def compile_c(name: str, sources: list[Path]) -> Any:
    """A module with `ffi` and the functions `lib` of C sources of this package, as one; collective.

    sources: their paths, without an ending, each with its declarations beside it.
    """
    declared = "\n".join(source.with_suffix(".h").read_text() for source in sources)
    defined = [source.with_suffix(".c").read_text() for source in sources]
    text = "\n".join(["#include <stdint.h>", declared, *defined])
    key = hashlib.sha256("".join([text, cffi.__version__, *FLAGS]).encode()).hexdigest()[:16]
    name = f"{name}_{key}"
    library = _folder() / f"{name}{sysconfig.get_config_var('EXT_SUFFIX')}"

    def build() -> None:
        if not library.is_file() or not is_whole(library):
            compiler = cffi.FFI()
            compiler.cdef(declared)
            compiler.set_source(name, text, extra_compile_args=[*FLAGS, *UNROLLED])
            # Beside the library, so that it is there as a whole or not at all, whoever else makes it.
            with tempfile.TemporaryDirectory(dir=library.parent) as folder, redirect_stdout(io.StringIO()):
                Path(compiler.compile(tmpdir=folder)).replace(library)

    parallel.on_root(build)
    found = importlib.util.spec_from_file_location(name, library)
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def blocked_by(error: Exception, folder: Path) -> Path | None:
    """The source of the entry of a folder that never gets ready, or that cannot be loaded; else None."""
    stale = _STALE.search(str(error))
    if stale is not None:
        return Path(stale[1])
    library = getattr(error, "path", None)
    # Without memory any library may fail to load, such as that of a package, which is not ours to remove.
    if library is None or Path(library).parent != folder:
        return None
    return folder / f"{Path(library).name.partition('.')[0]}.c"


def _compile(form: ufl.Form) -> fem.forms.CompiledForm:
    options = {"timeout": PATIENCE, "cffi_extra_compile_args": FLAGS, "cache_dir": _folder()}
    return fem.compile_form(MPI.COMM_WORLD, form, jit_options=options)


@cache
def _folder() -> Path:
    """Where compiled forms are kept, without broken entries; collective when it is first asked for."""
    return parallel.on_root(lambda: sound_cache(Path(dolfinx.jit.get_options()["cache_dir"])))


def sound_cache(folder: Path) -> Path:
    """The folder without its broken entries, or a folder for this process where it cannot be used."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
        for name in _broken(folder):
            _remove(folder / f"{name}.c")
    except OSError:
        return Path(_own_folder().name)
    return folder


@cache
def _own_folder() -> tempfile.TemporaryDirectory[str]:
    """A folder that is removed when the process ends."""
    return tempfile.TemporaryDirectory(prefix="fsi-forms-")


def _broken(folder: Path) -> list[str]:
    """The entries that are ready without a whole library, or have been getting ready for too long.

    By one look at a folder of perhaps thousands of files, most of which are opened: paths as text, as `Path`
    takes ten times as long.
    """
    with os.scandir(folder) as files:
        named = [(file.name.partition("."), file) for file in files]
    sources = {name: file for (name, _, ending), file in named if ending == "c"}
    ready = {name for (name, _, ending), _ in named if ending == _READY}
    libraries: dict[str, list[str]] = {name: [] for name in sources}
    for (name, _, ending), file in named:
        if ending.endswith("so") and name in libraries:
            libraries[name].append(file.path)
    oldest = time.time() - 2 * PATIENCE

    def is_broken(name: str) -> bool:
        if name not in ready:
            return sources[name].stat().st_mtime < oldest
        return not libraries[name] or not all(map(is_whole, libraries[name]))

    return list(filter(is_broken, sources))


def is_whole(library: str | Path) -> bool:
    """Whether a library reaches as far as its header says: the table of its sections stands at its end."""
    with io.FileIO(library) as file:
        header, length = file.read(_HEADER), os.fstat(file.fileno()).st_size
    if not header.startswith(_ELF) or len(header) < _HEADER:
        return False
    (table,) = struct.unpack_from("<Q", header, 40)
    size, count = struct.unpack_from("<HH", header, 58)
    return bool(table + size * count <= length)


def _remove(source: Path) -> None:
    """All files of an entry, last the source: while that is there nobody else makes the entry anew."""
    for file in (*(set(source.parent.glob(f"{source.stem}.*")) - {source}), source):
        file.unlink(missing_ok=True)
