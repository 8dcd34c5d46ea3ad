"""Keys that a study varies: each has its values from one place, so that tables say what was run."""

from collections.abc import Sequence
from itertools import combinations

from fsi.errors import InputError


def require_apart(varied: Sequence[str], overrides: Sequence[str]) -> None:
    """Raise InputError if of some varied keys two are the same or one is in another, or overrides change one.

    varied: dotted keys; overrides: changes of the case, `key=value`, which the values would undo.
    """
    for one, other in combinations(varied, 2):
        if one == other:
            raise InputError(f"--vary {one}: is given twice; give all its values at once")
        inner, outer = (one, other) if _in(one, other) else (other, one)
        if _in(inner, outer):
            raise InputError(f"--vary {inner}: is a part of {outer}, which varies too; drop one of them")
    for text in overrides:
        key = text.partition("=")[0].strip()
        for name in varied:
            if key == name or _in(key, name):
                raise InputError(f"--set {text}: is lost, as {name} varies; drop one of them")


def _in(inner: str, outer: str) -> bool:
    """Whether a dotted key is in the section or list that another one is."""
    return inner.startswith(f"{outer}.")
