"""Every word that ranks exchange outside the linear algebra; serial where no `mpiexec` is."""

import os
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from threading import RLock
from types import TracebackType
from typing import Any, NoReturn
from zlib import crc32

import numpy as np

from fsi.errors import InputError
from fsi.machine.ranks import STARTED
from fsi.meshes.mpi import load_mpi

type Words = Callable[[BaseException], tuple[str, int]]

PATIENCE = 5.0  # seconds that a rank which fails waits for the others to fail with it
TO_BE_HEARD = 1.0  # seconds that a launcher may need to pass on the last words before it ends

MPI: Any = load_mpi() if STARTED else None

_comm: Any = None if MPI is None else MPI.COMM_WORLD
_alarm: Any = None if MPI is None else _comm.Dup()  # its own, so that an alarm meets no other message

_turn = RLock()  # gmsh, PETSc and MPI have one state for all threads of a process


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


def require_same(what: str, content: Callable[[], bytes]) -> None:
    """Raise InputError on every rank unless all have the same content; collective.

    One process makes no content.
    """
    if size() > 1 and len(set(gather(sha256(content()).digest()))) > 1:
        raise InputError(f"{what}: not the same on all ranks; give the same on each")


def speak_with(words: Words) -> None:
    """Say what `settle` says of an error, and which exit code it ends with."""
    global _words
    _words = words


def settle(error: BaseException | None) -> None:
    """Come back once every rank has called this with an error of that kind at that place; at once for None.

    A rank that fails alone can neither go on nor clean up: the others wait for it in some exchange, and it
    would wait for them in the next. After PATIENCE it says why and ends them all. So whoever goes on after
    an error, or frees in a clean-up what ranks share, calls this first.
    """
    if error is None or size() == 1:
        return
    at = error.__traceback__
    place = "" if at is None else f"{at.tb_frame.f_code.co_filename}:{at.tb_lineno}"
    if not _all_at(f"{type(error).__qualname__} {place}"):
        message, exit_code = _words(error)
        _end_all(f"{message.rstrip()} (on rank {rank()} of {size()})", exit_code)


@contextmanager
def together() -> Iterator[None]:
    """Let an error pass only if every rank has it, see `settle`."""
    try:
        yield
    except BaseException as error:
        settle(error)
        raise


@contextmanager
def together_in_turn() -> Iterator[None]:
    """The same for what users call: one thread at a time, which may call more of it inside."""
    with _turn, together():
        yield


def last_words(message: str, exit_code: int) -> int:
    """Say on stderr, once, why the program ends; each rank that has failed calls it.

    When every rank gets here within PATIENCE, root speaks and all leave by themselves.
    Otherwise the others may wait for this rank for ever: it speaks and ends them all.

    Returns:
        the exit code to leave with, root's.
    """
    if not _all_at("the end"):
        _end_all(message, exit_code)
    if is_root():
        _say(message)
    return exit_code if size() == 1 else int(_alarm.bcast(exit_code, root=0))


def _all_at(place: str) -> bool:
    """True once every rank has called this with the same place; False if one does not within PATIENCE."""
    if size() == 1:
        return True
    places = np.zeros(size(), dtype=np.int64)
    places[rank()] = crc32(place.encode())
    arrival = _alarm.Iallgather(MPI.IN_PLACE, places)
    # Ranks that fail without the others give up one after the other, so that only one speaks.
    deadline = time.monotonic() + PATIENCE * (1.0 + 0.1 * rank())
    while not arrival.Test():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.01)
    if len(set(places)) == 1:
        return True
    if not is_root():
        time.sleep(PATIENCE)  # each fails with its own error: root speaks first
    return False


def _end_all(message: str, exit_code: int) -> NoReturn:
    """Speak, unless another rank has begun to, and end all ranks."""
    silent = _is_spoken()
    if not silent:
        for other in set(range(size())) - {rank()}:
            _alarm.Isend(b"", dest=other)
        _say(message)
    time.sleep(5.0 * TO_BE_HEARD if silent else TO_BE_HEARD)
    _comm.Abort(exit_code)
    os._exit(exit_code)  # Abort may come back before it takes hold


def _is_spoken() -> bool:
    """Whether another rank has begun to speak; its word may take some looks to get here."""
    for _ in range(10):
        if _alarm.Iprobe():
            return True
        time.sleep(0.01)
    return False


def _say(message: str) -> None:
    with suppress(OSError):  # nobody listens, but the exit code tells
        print(message, file=sys.__stderr__, flush=True)


def _traceback(error: BaseException) -> tuple[str, int]:
    """What Python says of an error that nobody catches."""
    words = "".join(traceback.format_exception(error))
    match error:
        case SystemExit(code=int() as code) if code:  # not 0: the others are ended, and nothing is done
            return words, code
        case _:
            return words, getattr(error, "exit_code", 1)


def _uncaught(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Python's last word on an error in a user's program: once, and the others do not wait for its rank."""
    settle(error)
    if is_root():
        sys.__excepthook__(kind, error, trace)


_words: Words = _traceback
if size() > 1:
    sys.excepthook = _uncaught
