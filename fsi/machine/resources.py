"""What this machine holds, and the refusal of work that it does not."""

import math
import os
import shutil
from pathlib import Path

from fsi.errors import InputError

# Where Linux says how much memory a container may take: version 2, then 1.
_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
_UNITS = ((1e18, "EB"), (1e15, "PB"), (1e12, "TB"), (1e9, "GB"), (1e6, "MB"))


def memory() -> float:
    """Bytes of memory: the machine's, or what its container may take of them."""
    found = [float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")]
    for limit in map(Path, _LIMITS):
        text = limit.read_text().strip() if limit.is_file() else ""
        found += [float(text)] if text.isdecimal() else []
    return min(found)


def free_disk(path: Path) -> float:
    """Bytes that are free where a path is, or will be."""
    path = path.absolute()
    there = next(folder for folder in (path, *path.parents) if folder.exists())
    return float(shutil.disk_usage(there).free)


def require_memory(what: str, need: float, remedy: str) -> None:
    """Raise InputError where work needs more bytes than there are; what: key, value and what it makes."""
    if not need <= memory():
        raise InputError(
            f"{what}, for which some {size(need)} are needed, of {size(memory())} here; {remedy}"
        )


def require_disk(what: str, need: float, remedy: str, path: Path) -> None:
    """Raise InputError where the files of some work need more bytes than are free."""
    if not need <= (free := free_disk(path)):
        raise InputError(f"{what}, with some {size(need)} of files, of {size(free)} free here; {remedy}")


def size(count: float) -> str:
    """Bytes as people read them: 24 GB."""
    unit, name = next((pair for pair in _UNITS if count >= pair[0]), (1e6, "MB"))
    return f"{count / unit:.3g} {name}" if math.isfinite(count) else "endless bytes"
