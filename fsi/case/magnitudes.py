"""How large and how small the numbers of a case may be.

Velocities are force / viscosity, volumes length^3, powers force^2 / viscosity: of numbers between 1e-50 and
1e50 these are at most 1e150, and floating-point numbers end at 1e308.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
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
    for key, value in _values({name: data[name] for name in sections if name in data}, ""):
        last = key.rpartition(".")[2]
        size = max((abs(number) for number in _numbers(value)), default=0.0)
        small = 0.0 < size < SMALLEST and last not in _PLACES
        if (small or size > LARGEST) and last not in _NO_UNIT:
            bounds = f"{SMALLEST:g} to {LARGEST:g} in size"
            raise refusal(key, value, f"too small or too large for numbers, {bounds}; give other units")


def _values(data: Any, key: str) -> Iterator[tuple[str, Any]]:
    """The numbers and lists of numbers in nested tables, with their dotted keys."""
    match data:
        case dict():
            entries: Iterable[tuple[Any, Any]] = data.items()
        case list() | tuple() if any(isinstance(item, dict) for item in data):
            entries = enumerate(data)
        case _:
            yield key, data
            return
    for name, value in entries:
        yield from _values(value, f"{key}.{name}" if key else str(name))


def _numbers(value: Any) -> Iterator[float]:
    """The finite ones in nested lists."""
    match value:
        case list() | tuple():
            for item in value:
                yield from _numbers(item)
        case bool():
            return
        case int():
            yield value
        case float() if math.isfinite(value):
            yield value
