"""Loops that Numba compiles, once for each state of their sources.

Numba keeps machine code by the date of the file that a function stands in, not of those that it calls, so
that a change of one file would leave old code of another in use. Here all files of this package decide
together.
"""

import hashlib
from collections.abc import Callable
from pathlib import Path

import numba


def _sources() -> str:
    """A word for the state of all files of this package."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _cache() -> Path:
    """Where the machine code lies: beside the sources, or in the user's cache if they are read-only."""
    beside = Path(__file__).parent / "__pycache__"
    try:
        beside.mkdir(exist_ok=True)
        (beside / f"numba-{_STATE}").mkdir(exist_ok=True)
    except OSError:
        return Path.home() / ".cache" / "fsi" / f"numba-{_STATE}"
    return beside / f"numba-{_STATE}"


_STATE = _sources()
_CACHE = str(_cache())


def compiled[**P, R](function: Callable[P, R]) -> Callable[P, R]:
    """The function in machine code, made at its first call and kept for the next programs."""
    settings = vars(numba.config)
    before, settings["CACHE_DIR"] = settings["CACHE_DIR"], _CACHE
    try:
        fast: Callable[P, R] = numba.njit(cache=True, error_model="numpy")(function)
    finally:
        settings["CACHE_DIR"] = before
    return fast
