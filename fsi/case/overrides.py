"""`--set key=value`: change one value of a case before it is checked."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from fsi.case.section import toml_text
from fsi.errors import InputError

_REMEDY = "write key=value, for instance --set discretisation.degree=2"

_QUOTED = 'domain.mesh="mine.msh"'


def override(data: dict[str, Any], text: str) -> None:
    """Set one value in the nested data of a case file, in place.

    Args:
        data: dictionaries and lists as TOML gives them; whether the key is known is checked later.
        text: `key=value`; the key is dotted, bodies count from 0 (`bodies.0.radius`); the value is
            TOML, where a single word needs no quotes.

    Raises:
        InputError: no `=`, a value that is not TOML, or a key that leads through no section.
    """
    key, separator, value = (part.strip() for part in text.partition("="))
    if not (key and separator):
        raise InputError(f"--set {text}: no key=value; {_REMEDY}")
    *path, last = key.split(".")
    here: Any = data
    for depth, part in enumerate(path):
        here = _enter(here, part, ".".join(path[: depth + 1]), text)
    if isinstance(here, dict):
        here[last] = _toml_value(value, text)
    else:
        here[_index(here, last, key, text)] = _toml_value(value, text)


def _enter(here: Any, part: str, key: str, text: str) -> Any:
    """The section or list `part` of `here`; a section that is not there yet is made."""
    inner = here.setdefault(part, {}) if isinstance(here, dict) else here[_index(here, part, key, text)]
    if not isinstance(inner, dict | list):
        raise InputError(f"--set {text}: {key} = {toml_text(inner)} is no section; set {key} itself")
    return inner


def _index(items: list[Any], part: str, key: str, text: str) -> int:
    if part.isdecimal() and int(part) < len(items):
        return int(part)
    raise InputError(f"--set {text}: no {key}; the list has the entries 0 to {len(items) - 1}")


def _toml_value(value: str, text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {value}")
    except tomllib.TOMLDecodeError:
        if re.fullmatch(r"[A-Za-z][\w-]*", value):
            return value
        parsed = {}
    if set(parsed) != {"value"}:
        raise InputError(f"--set {text}: the value is not TOML; {_REMEDY}, or '{_QUOTED}' for other text")
    return parsed["value"]
