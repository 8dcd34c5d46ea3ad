"""Work that threads share: loops in machine code, which leave Python's lock to others while they run."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise


def in_parts(count: int, work: Callable[[slice], None]) -> None:
    """Have so many things done, in as many parts as `OMP_NUM_THREADS` says; without it in one.

    What is done to one thing must not depend on the others, so that the number of threads changes no digit.
    """
    threads = min(_threads(), count)
    if threads <= 1:
        work(slice(0, count))
        return
    ends = [count * k // threads for k in range(threads + 1)]
    parts = [slice(first, end) for first, end in pairwise(ends)]
    list(_pool(threads).map(work, parts))  # what goes wrong in a part is raised here


def _threads() -> int:
    """OMP_NUM_THREADS, of whose list of levels the first; 1 where it is no number."""
    first = os.environ.get("OMP_NUM_THREADS", "").split(",")[0].strip()
    return max(int(first), 1) if first.isdecimal() else 1


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads)
