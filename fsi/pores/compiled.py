"""Loops that Numba compiles."""

from collections.abc import Callable

import numba


def compiled[**P, R](function: Callable[P, R]) -> Callable[P, R]:
    """The function in machine code, made at its first call and kept beside its file."""
    fast: Callable[P, R] = numba.njit(cache=True, error_model="numpy")(function)
    return fast
