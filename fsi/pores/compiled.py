"""Loops that Numba compiles, once for each state of their sources.

Numba keeps machine code by the date of the file that a function stands in, not of those that it calls, so
that a change of one file would leave old code of another in use. Here all files that have to do with loops
decide together.
"""

import hashlib
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba


def _sources() -> str:
    """A word for the state of the files that have such loops, and of those that these import."""
    text = {path.stem: path.read_text() for path in Path(__file__).parent.glob("*.py")}
    loops = {name for name in text if "from fsi.pores.compiled import" in text[name]}
    imported = {found for name in loops for found in re.findall(r"from fsi\.pores\.(\w+) import", text[name])}
    digest = hashlib.sha256()
    for name in sorted(loops | imported):
        digest.update(text[name].encode())
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


# Loops over points: products and sums in one rounding, long sums in any order, nothing that is no number.
_LOOSE = {"contract", "reassoc", "nsz", "nnan"}
# No way in from Python, which takes long to compile.
_INNER = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
# What makes no arrays need not count who holds those that it is given.
_NO_COUNTS = {"_nrt": False}


def compiled[**P, R](function: Callable[P, R]) -> Callable[P, R]:
    """The function in machine code, made at its first call and kept for the next programs."""
    return _kept(function)


def internal[**P, R](function: Callable[P, R]) -> Callable[P, R]:
    """The same for what other compiled functions alone call."""
    return _kept(function, **_INNER)


def vectorised[**P, R](function: Callable[P, R]) -> Callable[P, R]:
    """The same for loops over points, which take several of them at once and make no arrays."""
    return _kept(function, fastmath=_LOOSE, **_INNER, **_NO_COUNTS)


def inlined[**P, R](function: Callable[P, R]) -> Callable[P, R]:
    """The same for what stands in such loops, where a call would keep from taking several at once."""
    return _kept(function, fastmath=_LOOSE, forceinline=True, **_INNER, **_NO_COUNTS)


def _kept[**P, R](function: Callable[P, R], **options: Any) -> Callable[P, R]:
    settings = vars(numba.config)
    before, settings["CACHE_DIR"] = settings["CACHE_DIR"], _CACHE
    try:
        fast: Callable[P, R] = numba.njit(cache=True, error_model="numpy", **options)(function)
    finally:
        settings["CACHE_DIR"] = before
    return fast
