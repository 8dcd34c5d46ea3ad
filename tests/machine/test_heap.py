"""Room for loops begins where a line of the processor's cache does."""

import numpy as np
import pytest

from fsi.machine.heap import LINE, aligned


@pytest.mark.parametrize("numbers", [1, 7, 1000, 300_000])
def test_room_begins_with_a_line_of_the_cache(numbers: int) -> None:
    """NumPy's own begins 16, 32 or 48 bytes behind one."""
    for _ in range(10):
        room = aligned(numbers)
        assert room.shape == (numbers,)
        assert room.dtype == np.float64
        assert room.ctypes.data % LINE == 0
        assert room.flags.c_contiguous
