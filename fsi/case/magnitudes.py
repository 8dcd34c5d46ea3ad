"""How large and how small the numbers of a case may be.

Velocities are force / viscosity, volumes length^3, powers force^2 / viscosity: of numbers between 1e-50 and
1e50 these are at most 1e150, and floating-point numbers end at 1e308.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from fsi.case.section import refusal

SMALLEST, LARGEST = 1e-50, 1e50
# Lengths, loads, velocities, viscosities and stresses stand in these; [[bodies]] may come from elsewhere.
GIVEN = ("fluid", "domain", "body_defaults", "grids", "forces")
_NO_UNIT = ("angle",)
_PLACES = ("position", "lower")  # which may be as near to the origin as they like
_WHOLE = 2**63  # whole numbers are smaller, as in TOML


def check_magnitudes(data: Mapping[str, Any], sections: Iterable[str]) -> None:
    """Refuse numbers beyond 1e50 in size and, but for zero, below 1e-50; of a list its largest counts.

    Raises InputError: the first, with its key. What is no finite number is the schema's to refuse.
    """
    for name in sections:
        if name in data and (found := _first(data[name], name, _is_beyond)):
            keys, value = found
            bounds = f"{SMALLEST:g} to {LARGEST:g} in size"
            what = f"too small or too large for numbers, {bounds}; give other units"
            raise refusal(".".join(keys), value, what)


def check_whole_numbers(data: Mapping[str, Any]) -> None:
    """Refuse whole numbers of more than 64 bits, which no file has.

    Raises InputError: the first, with its key.
    """
    for name in data:
        if found := _first(data[name], str(name), _is_too_long):
            keys, value = found
            raise refusal(".".join(keys), value, "a whole number has more than 64 bits; give a smaller one")


def _first(data: Any, name: str, wrong: Callable[[Any, str], bool]) -> tuple[tuple[str, ...], Any] | None:
    """The first number or list in nested tables that is wrong under its name, and its keys from `name` on."""
    if isinstance(data, dict):
        entries: Iterable[tuple[Any, Any]] = data.items()
    elif isinstance(data, list | tuple) and any(isinstance(item, dict) for item in data):
        entries = enumerate(data)
    else:
        return ((name,), data) if wrong(data, name) else None
    for key, value in entries:
        if found := _first(value, str(key), wrong):
            return (name, *found[0]), found[1]
    return None


def _is_beyond(value: Any, name: str) -> bool:
    """Whether the largest number of a value is too small or too large for its name."""
    size = _size(value)
    small = 0.0 < size < SMALLEST and name not in _PLACES
    return (small or size > LARGEST) and name not in _NO_UNIT


def _is_too_long(value: Any, name: str) -> bool:
    """Whether there is a whole number of more than 64 bits in nested lists."""
    if isinstance(value, list | tuple):
        return any(_is_too_long(item, name) for item in value)
    return isinstance(value, int) and not -_WHOLE <= value < _WHOLE


def _size(value: Any) -> float:
    """The largest finite number in nested lists; 0 where there is none."""
    if isinstance(value, list | tuple):
        return max(map(_size, value), default=0.0)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return abs(value) if is_number and (isinstance(value, int) or math.isfinite(value)) else 0.0
