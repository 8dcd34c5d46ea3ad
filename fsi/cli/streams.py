"""Standard streams that may be closed, full, or of an encoding without the letters of a name."""

import os
import signal
import sys
from contextlib import suppress
from io import TextIOWrapper
from pathlib import Path
from typing import Any, TextIO

from fsi.errors import SolveError

_UNBROKEN = "10000"  # columns: more than the help of any option has


def prepare(*, silent: bool) -> None:
    """Make all streams ones that can be used; silent: standard output goes nowhere.

    Letters that the encoding lacks are written as their numbers. Where a stream was closed before the start,
    Python has None in its place. A reader that goes away is a BrokenPipeError and no signal: Python ignores
    that, but gmsh, as it starts, sets it back to end the program. COLUMNS=0 is a width that nobody knows, and
    not that of a terminal without any. Where the shell completes a word, to which each line is a candidate,
    help is not broken into lines.
    """
    if "_FSI_COMPLETE" in os.environ:
        os.environ["COLUMNS"] = _UNBROKEN
    if os.environ.get("COLUMNS", "1").strip("0") == "":
        del os.environ["COLUMNS"]
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
    if sys.stdin is None:
        sys.stdin = _nothing("r")
    if silent or sys.stdout is None:
        sys.stdout = _nothing("w")
    if sys.stderr is None:
        sys.stderr = sys.__stderr__ = _nothing("w")  # type: ignore[misc]
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _nothing(mode: str) -> Any:
    """What stands for a stream, open for as long as we run: it ends at once, or goes nowhere."""
    return Path(os.devnull).open(mode, encoding="utf-8")


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
