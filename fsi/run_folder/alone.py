"""One process at a time in a folder; the lock of one that is killed goes with it."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import fsi.parallel as parallel
from fsi.errors import InputError


@contextmanager
def alone(path: Path, refused: Path | None = None) -> Iterator[None]:
    """Keep other processes from a folder or file for as long, on all ranks; collective. See `locked`."""
    with ExitStack() as held:
        parallel.on_root(lambda: held.enter_context(locked(path, refused)))
        yield


@contextmanager
def locked(path: Path, refused: Path | None = None) -> Iterator[None]:
    """The same of this rank. Where nothing can be locked, or nothing is there, nobody is kept from it.

    refused: what another process is told that it cannot have; if not given, it waits.

    Raises InputError: another process holds it.
    """
    with ExitStack() as held:
        with suppress(OSError):  # network drives lock no folders, some no files; whoever needs it will say so
            file = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
            held.callback(os.close, file)
            try:
                fcntl.flock(file, fcntl.LOCK_EX | (fcntl.LOCK_NB if refused else 0))
            except BlockingIOError:
                raise InputError(
                    f"output = {refused}: another process runs this; wait for its end, or give another folder"
                ) from None
        yield
