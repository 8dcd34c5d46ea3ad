"""What whole processes take."""

import resource
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path


def cpu_seconds(command: Sequence[str], environment: Mapping[str, str], folder: Path) -> float:
    """CPU seconds of a command, run in a folder, with those of the processes that it starts.

    Raises subprocess.CalledProcessError: it fails. What it prints goes nowhere.
    """
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
