"""How large and how small the numbers of a case may be.

Velocities are force / viscosity, volumes length^3, powers force^2 / viscosity: of numbers between 1e-50 and
1e50 these are at most 1e150, and floating-point numbers end at 1e308.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from fsi.case.section import refusal

SMALLEST, LARGEST = 1e-50, 1e50
# Lengths, loads, velocities, viscosities and stresses stand in these; [[bodies]] may come from elsewhere.
GIVEN = ("fluid", "domain", "body_defaults", "grids", "forces")
_NO_UNIT = ("angle",)
_PLACES = ("position", "lower")  # which may be as near to the origin as they like


def check_magnitudes(data: Mapping[str, Any], sections: Iterable[str]) -> None:
    """Refuse numbers beyond 1e50 in size and, but for zero, below 1e-50; of a list its largest counts.

    Raises InputError: the first, with its key. What is no finite number is the schema's to refuse.
    """
    for name in sections:
        if name in data and (found := _first(data[name], name)):
            keys, value = found
            bounds = f"{SMALLEST:g} to {LARGEST:g} in size"
            what = f"too small or too large for numbers, {bounds}; give other units"
            raise refusal(".".join(keys), value, what)


def _first(data: Any, name: str) -> tuple[tuple[str, ...], Any] | None:
    """The first that is too small or too large in nested tables, and its keys from `name` on."""
    if isinstance(data, dict):
        entries: Iterable[tuple[Any, Any]] = data.items()
    elif isinstance(data, list | tuple) and any(isinstance(item, dict) for item in data):
        entries = enumerate(data)
    else:
        size = _size(data)
        small = 0.0 < size < SMALLEST and name not in _PLACES
        return ((name,), data) if (small or size > LARGEST) and name not in _NO_UNIT else None
    for key, value in entries:
        if found := _first(value, str(key)):
            return (name, *found[0]), found[1]
    return None


def _size(value: Any) -> float:
    """The largest finite number in nested lists; 0 where there is none."""
    if isinstance(value, list | tuple):
        return max(map(_size, value), default=0.0)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return abs(value) if is_number and (isinstance(value, int) or math.isfinite(value)) else 0.0
