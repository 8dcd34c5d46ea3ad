"""What this machine holds, and the refusal of work that it does not."""

import math
import os
import resource
import shutil
from collections.abc import Iterator
from pathlib import Path

from fsi.errors import InputError

# Where Linux says which groups a process is in, and, below, how much memory each may take: version 2, then 1.
_GROUPS = Path("/proc/self/cgroup")
_LIMITS = {"": (Path("/sys/fs/cgroup"), "memory.max"),
           "memory": (Path("/sys/fs/cgroup/memory"), "memory.limit_in_bytes")}  # fmt: skip
_UNITS = ((1e18, "EB"), (1e15, "PB"), (1e12, "TB"), (1e9, "GB"), (1e6, "MB"))


def memory() -> float:
    """Bytes of memory: the machine's, or what this process or its container may take of them."""
    found = [float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE"), *_limits()]
    most, _ = resource.getrlimit(resource.RLIMIT_AS)  # of `ulimit -v`
    return min(found if most == resource.RLIM_INFINITY else [*found, float(most)])


def _limits() -> Iterator[float]:
    """Those of the groups that this process is in, one in the other; the outermost is a container's own."""
    own = dict.fromkeys(_LIMITS, "")
    for line in _GROUPS.read_text().splitlines() if _GROUPS.is_file() else ():
        _, controllers, group = line.split(":", 2)
        own |= {known: group.strip("/") for known in _LIMITS if known in controllers.split(",")}
    for controllers, (root, name) in _LIMITS.items():
        innermost = root / own[controllers]
        for folder in (innermost, *innermost.parents):
            if folder.is_relative_to(root) and (folder / name).is_file():
                text = (folder / name).read_text().strip()
                yield from [float(text)] if text.isdecimal() else []


def free_disk(path: Path) -> float:
    """Bytes that are free where a path is, or will be."""
    path = path.absolute()
    there = next(folder for folder in (path, *path.parents) if folder.exists())
    return float(shutil.disk_usage(there).free)


def require_memory(what: str, need: float, remedy: str, within: float = 1.0) -> None:
    """Raise InputError where work needs more bytes than there are; what: key, value and what it makes.

    within: the factor by which there may be less of the need.
    """
    if not need / within <= memory():
        raise InputError(
            f"{what}, for which some {size(need)} are needed, of {size(memory())} here; {remedy}"
        )


def require_disk(what: str, need: float, remedy: str, path: Path, within: float = 1.0) -> None:
    """Raise InputError where the files of some work need more bytes than are free, as `require_memory`."""
    if not need / within <= (free := free_disk(path)):
        there = f"of {size(free)} free in {path.absolute()}"
        raise InputError(f"{what}, with some {size(need)} of files, {there}; {remedy}")


def size(count: float) -> str:
    """Bytes as people read them: 24 GB."""
    unit, name = next((pair for pair in _UNITS if count >= pair[0]), (1e6, "MB"))
    return f"{count / unit:.3g} {name}" if math.isfinite(count) else "endless bytes"
