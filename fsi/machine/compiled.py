"""Loops that Numba compiles, once for each state of their sources.

Numba keeps machine code by the date of the file that a function stands in, not of those that it calls, so
that a change of one file would leave old code of another in use. Here all files of a room that have to do
with loops decide together.
"""

import hashlib
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba


def _state(room: Path) -> str:
    """A word for the state of the files of a room that have such loops, and of those that these import."""
    text = {path.stem: path.read_text() for path in room.glob("*.py")}
    loops = {name for name in text if "from fsi.machine.compiled import" in text[name]}
    of_room = rf"from fsi\.{room.name}\.(\w+) import"
    imported = {found for name in loops for found in re.findall(of_room, text[name])}
    digest = hashlib.sha256(Path(__file__).read_bytes())
    for name in sorted(loops | imported):
        digest.update(text[name].encode())
    return digest.hexdigest()[:16]


@cache
def _folder(room: Path) -> str:
    """Where the machine code of a room lies: beside its sources, or in the user's cache if read-only."""
    beside, name = room / "__pycache__", f"numba-{_state(room)}"
    try:
        beside.mkdir(exist_ok=True)
        (beside / name).mkdir(exist_ok=True)
    except OSError:
        return str(Path.home() / ".cache" / "fsi" / name)
    return str(beside / name)


# Loops over points: products and sums in one rounding, long sums in any order, nothing that is no number.
_LOOSE = {"contract", "reassoc", "nsz", "nnan"}
# No way in from Python, which takes long to compile.
_INNER = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
# What makes no arrays need not count who holds those that it is given.
_NO_COUNTS = {"_nrt": False}


def compiled[**P, R](function: Callable[P, R]) -> Callable[P, R]:
    """The function in machine code, made at its first call and kept for the next programs.

    Other threads run while it does.
    """
    return _kept(function, nogil=True)


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
    settings, room = vars(numba.config), Path(function.__code__.co_filename).parent
    before, settings["CACHE_DIR"] = settings["CACHE_DIR"], _folder(room)
    try:
        fast: Callable[P, R] = numba.njit(cache=True, error_model="numpy", **options)(function)
    finally:
        settings["CACHE_DIR"] = before
    return fast
