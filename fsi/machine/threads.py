"""Threads: how many, and work that they share, loops in machine code that leave Python's lock to others."""

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from typing import TYPE_CHECKING

from fsi.machine.ranks import STARTED

if TYPE_CHECKING:  # it takes longer to load than what has no threads may wait
    from concurrent.futures import Future, ThreadPoolExecutor

GIVEN = os.environ.get("OMP_NUM_THREADS")  # None where the user does not say
# More threads of libraries slow small factorisations down and change the last bits; MPI is the way to use
# cores. It must be said before NumPy is loaded, whose own threads otherwise spin between two calls.
os.environ.setdefault("OMP_NUM_THREADS", "1")


def in_turn[T, R](work: Callable[[T], R], given: Iterable[T]) -> Iterator[R]:
    """What work makes of each, one after the other, while threads are at the next ones; raises what it does.

    What becomes of one must not depend on the others, so that the number of threads changes no digit.
    """
    threads = number_of_threads()
    if threads == 1:
        yield from map(work, given)
        return
    pool, begun = _pool(threads), deque["Future[R]"]()
    for one in given:
        begun.append(pool.submit(work, one))
        if len(begun) > threads:
            yield begun.popleft().result()
    while begun:
        yield begun.popleft().result()


def number_of_threads() -> int:
    """OMP_NUM_THREADS, of whose list of levels the first, 1 where it is no number.

    Where it is not given all processors that this process may use, or one for each of several ranks.
    """
    if GIVEN is None:
        return 1 if STARTED else _processors()
    first = GIVEN.split(",")[0].strip()
    return max(int(first), 1) if first.isdecimal() else 1


def _processors() -> int:
    known = getattr(os, "sched_getaffinity", None)  # of Linux
    return len(known(0)) if known else os.cpu_count() or 1


@cache
def _pool(threads: int) -> "ThreadPoolExecutor":
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(threads)
