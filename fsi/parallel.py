"""Every word that ranks exchange outside the linear algebra; serial where mpi4py is absent."""

import importlib.util
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import fsi.meshes.backend  # noqa: F401  (loads MPI in the right order)

_comm: Any = None
_alarm: Any = None  # its own communicator, so that an alarm meets no other message
if importlib.util.find_spec("mpi4py") is not None:
    from mpi4py import MPI

    _comm = MPI.COMM_WORLD
    _alarm = _comm.Dup()


def rank() -> int:
    """This process's rank."""
    return 0 if _comm is None else int(_comm.Get_rank())


def size() -> int:
    """Number of ranks."""
    return 1 if _comm is None else int(_comm.Get_size())


def is_root() -> bool:
    """True on the rank that prints and writes tables."""
    return rank() == 0


def on_root[T](action: Callable[[], T]) -> T:
    """Run `action` on root alone, give its result to all ranks, raise its error on all ranks."""
    if size() == 1:
        return action()
    result: T | None = None
    error: Exception | None = None
    if is_root():
        try:
            result = action()
        except Exception as failure:  # every rank must learn of it, or the others would wait for ever
            error = failure
    result, error = _comm.bcast((result, error), root=0)
    if error is not None:
        raise error
    return result


def on_every_rank(action: Callable[[], None]) -> None:
    """Run `action` on each rank; where it fails on any, raise the first rank's error on all of them."""
    error: Exception | None = None
    try:
        action()
    except Exception as failure:  # as in `on_root`
        error = failure
    for failed in gather(error):
        if failed is not None:
            raise failed


def gather[T](value: T) -> list[T]:
    """The values of all ranks, in their order, on every rank."""
    return [value] if size() == 1 else list(_comm.allgather(value))


def last_words(message: str, exit_code: int, patience: float = 3.0) -> int:
    """Say on stderr, once, why the program ends; each rank that has failed calls it.

    When every rank gets here within `patience` seconds, root speaks and all leave by themselves.
    Otherwise the others may wait for this rank for ever: it speaks and ends them all.

    Returns:
        the exit code to leave with, root's.
    """
    # Ranks that fail without the others give up one after the other, so that only one speaks.
    together = _all_arrive(patience * (1.0 + 0.1 * rank()))
    if is_root() or not together:
        with suppress(OSError):  # nobody listens, but the exit code tells
            print(message, file=sys.__stderr__, flush=True)
    if not together:
        _comm.Abort(exit_code)
    return exit_code if size() == 1 else int(_alarm.bcast(exit_code, root=0))


def _all_arrive(patience: float) -> bool:
    """True once every rank has called this; False if one has not after `patience` seconds."""
    if size() == 1:
        return True
    arrival = _alarm.Ibarrier()
    deadline = time.monotonic() + patience
    while not arrival.Test():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.01)
    return True
