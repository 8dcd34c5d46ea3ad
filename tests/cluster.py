"""Processes that are started, watched and killed: commands of this program, and a Dask cluster."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[1]


@contextmanager
def process(*arguments: object) -> Iterator[subprocess.Popen[str]]:
    """A module of Python with its arguments, killed at the end."""
    command = [sys.executable, "-m", *map(str, arguments)]
    with subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as one:
        try:
            yield one
        finally:
            one.kill()


@contextmanager
def scheduler(folder: Path) -> Iterator[tuple[str, tuple[object, ...]]]:
    """A scheduler of Dask: its address, and the arguments of `process` that make a worker of it."""
    contact = folder / "scheduler.json"
    with process(
        "distributed.cli.dask_scheduler", "--port", 0, "--no-dashboard", "--scheduler-file", contact
    ):
        wait_until(contact.exists)
        address = json.loads(contact.read_text())["address"]
        yield (
            address,
            ("distributed.cli.dask_worker", address, "--nthreads", 1, "--no-nanny", "--no-dashboard"),
        )


def wait_until(done: Callable[[], bool]) -> None:
    """Wait for up to ten minutes. Raises TimeoutError."""
    for _ in range(6000):
        if done():
            return
        time.sleep(0.1)
    raise TimeoutError
