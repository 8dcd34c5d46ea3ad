"""Standard streams that may be closed, full, or of an encoding without the letters of a name."""

import os
import signal
import sys
from contextlib import suppress
from io import TextIOWrapper
from typing import TextIO

from fsi.errors import SolveError


def prepare(*, silent: bool) -> None:
    """Make all streams ones that can be used; silent: standard output goes nowhere.

    Letters that the encoding lacks are written as their numbers. Where a stream was closed before the start,
    Python has None in its place. A reader that goes away is a BrokenPipeError and no signal: Python ignores
    that, but gmsh, as it starts, sets it back to end the program.
    """
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
    if sys.stdin is None:
        sys.stdin = open(os.devnull, encoding="utf-8")  # noqa: PTH123, SIM115  (for as long as we run)
    if silent or sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123, SIM115  (for as long as we run)
    if sys.stderr is None:
        sys.stderr = sys.__stderr__ = open(os.devnull, "w", encoding="utf-8")  # type: ignore[misc]  # noqa: PTH123, SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def finish(code: int) -> int:
    """Write out what the streams hold; the exit code, 3 where it was 0 and standard output takes no more."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except BrokenPipeError:
            _forsake(stream)
        except OSError as error:
            _forsake(stream)
            if code == 0:
                code = SolveError.exit_code
                sys.stderr.write(f"error: standard output: {error.strerror}; give another place\n")
    return code


def _forsake(stream: TextIO) -> None:
    """Let what is still to be written go nowhere: Python would fail over it once more when it ends."""
    with suppress(OSError, ValueError), open(os.devnull, "wb") as nowhere:  # noqa: PTH123
        os.dup2(nowhere.fileno(), stream.fileno())
