"""The runs of a study, each a process of its own, of one rank or several: if it crashes, it alone has failed.

A run has a folder, in which a command of this program finds what is asked for and leaves what it has found.
It ends with whoever has started it, by whatever death: it reads from a pipe that the other holds open.
"""

import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, as_completed
from pathlib import Path

import fsi.parallel as parallel
from fsi.errors import InputError

_running: set[subprocess.Popen[str]] = set()


def outcomes(
    pool: Executor, command: str, folders: Sequence[Path], ranks: int = 1
) -> Iterator[tuple[Path, str]]:
    """Folder after folder as the command has done it, and why it failed; empty if it did not."""
    running = {pool.submit(launched, command, str(folder), ranks): folder for folder in folders}
    for done in as_completed(running):
        lost = done.exception()  # of the cluster: a run itself has its words
        yield running[done], done.result() if lost is None else " ".join(str(lost).split())


def launched(command: str, folder: str, ranks: int) -> str:
    """Do one run in a process, or in several ranks, to its end; gives why it failed, empty if it did not."""
    words = [sys.executable, "-m", "fsi", command, folder]
    if ranks > 1:
        words = [mpiexec(), "-n", str(ranks), *words]
    with subprocess.Popen(
        words, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None  # and stdin stays open until it has ended
        _running.add(process)
        try:
            said = process.stderr.read()
            code = process.wait()
        finally:
            _running.discard(process)
    if code == 0:
        return ""
    lines = [line for line in said.splitlines() if line.startswith("error: ")] or said.splitlines()[-1:]
    return " ".join(lines[0].removeprefix("error: ").split()) if lines else f"ended with code {code}"


def end_runs() -> None:
    """Let the processes that this one has started end."""
    for process in _running.copy():
        assert process.stdin is not None
        process.stdin.close()


def mpiexec() -> str:
    """The launcher beside this Python, or on the path. Raises InputError: there is none."""
    beside = Path(sys.executable).with_name("mpiexec")
    found = str(beside) if beside.is_file() else shutil.which("mpiexec")
    if found is None:
        raise InputError("--ranks: there is no mpiexec here; run with one rank")
    return found


def end_with_parent() -> None:
    """Let this process end when the one that has started it does, even if that is killed."""

    def watch() -> None:
        while os.read(sys.stdin.fileno(), 1024):
            continue
        os._exit(1)

    if parallel.is_root():
        threading.Thread(target=watch, daemon=True).start()
