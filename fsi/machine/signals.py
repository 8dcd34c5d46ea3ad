"""Signals that end the program: Ctrl-C, SIGTERM of a batch system, SIGHUP of a lost connection."""

import _thread
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_SOON = 0.05  # seconds


class Ended(SystemExit):
    """A signal has asked for the end; exit_code is what shells say of it, 128 and its number."""

    def __init__(self, number: int) -> None:
        self.signal = signal.Signals(number).name
        self.exit_code = 128 + number
        super().__init__(self.exit_code)


@contextmanager
def held() -> Iterator[None]:
    """These signals come afterwards, to the handlers that were there; in the main thread, which has them.

    C++ libraries crash where Python raises something while they load. PETSc and UCX set handlers of their
    own, which print a page of theirs, and gmsh sets all back to what ends the process at once.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = {number: signal.getsignal(number) for number in _ENDING}
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, _ENDING)
    for number, handler in before.items():
        if callable(handler):  # another thread may still take it
            signal.signal(number, lambda number, _: came.append(number))
    try:
        yield
    finally:
        for number, handler in before.items():
            if handler is not None:  # not one that Python knows
                signal.signal(number, handler)
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
        if came:
            signal.raise_signal(came[0])


@contextmanager
def heard() -> Iterator[None]:
    """Raise Ended of SIGTERM and SIGHUP where they would end the process at once; of the first alone.

    What is open is then closed, and half a file removed, as it is of Ctrl-C. Python drops what is raised in
    a clean-up that it does by itself, as it may while it imports: then it comes once more.
    """
    asked = [number for number in _ENDING if signal.getsignal(number) is signal.SIG_DFL]

    def end(number: int, _: FrameType | None) -> None:
        for other in asked:
            signal.signal(other, signal.SIG_IGN)
        raise Ended(number)

    def again(told: "sys.UnraisableHookArgs") -> None:
        if isinstance(told.exc_value, KeyboardInterrupt | Ended):
            threading.Timer(_SOON, _thread.interrupt_main).start()
        else:
            before(told)

    for number in asked:
        signal.signal(number, end)
    before, sys.unraisablehook = sys.unraisablehook, again
    try:
        yield
    finally:
        sys.unraisablehook = before
        for number in asked:
            signal.signal(number, signal.SIG_DFL)
