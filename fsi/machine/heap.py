"""Memory: what a step frees is kept for the next one, and where what loops work in begins."""

import ctypes
import platform
from functools import cache

import numpy as np
from numpy.typing import NDArray

# <malloc.h> of glibc
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
LINE = 64  # bytes of the cache
MOST_KEPT, LARGEST = 2**31 - 1, 2**30  # bytes; what exceeds LARGEST still goes back when it is freed


@cache
def keep_freed() -> None:
    """Let glibc keep what one solve frees and the next one wants again, for this process.

    Given back, it would return page by page, cleared: a step of some hundred megabytes loses a twelfth of its
    time so. Elsewhere than on glibc: nothing.
    """
    if platform.libc_ver()[0] == "glibc":
        libc = ctypes.CDLL(None)
        libc.mallopt(M_TRIM_THRESHOLD, MOST_KEPT)
        libc.mallopt(M_MMAP_THRESHOLD, LARGEST)


def aligned(numbers: int) -> NDArray[np.float64]:
    """Room for numbers from where a line of the cache begins: several are loaded at once, of one line."""
    room = np.empty(numbers + LINE // 8)
    first = -room.ctypes.data % LINE // 8
    return room[first : first + numbers]
