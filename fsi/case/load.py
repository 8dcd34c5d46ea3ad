"""The case file: read, changed by `--set`, checked before anything is computed.

`load_case` reads a TOML file into a frozen `Case` or raises `InputError` with one line that names
the key, its value and the remedy.
"""

import os
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Any, get_args

import tomli_w
from pydantic import ValidationError

from fsi.case.arranged import with_arrangement
from fsi.case.body import Body, with_grids
from fsi.case.body_file import with_bodies
from fsi.case.case import MODELS, Case
from fsi.case.checks.sound import check_case
from fsi.case.complaints import explain
from fsi.case.section import CaseContext, Geometry, toml_data, toml_text, tuples
from fsi.errors import InputError
from fsi.files import plain, write_whole


def load_case(path: Path | str, overrides: Sequence[str] = ()) -> Case:
    """Read a case file; overrides are `key=value`, a dotted key (`bodies.0.radius=2`) and TOML, in order.

    Raises InputError: the file cannot be read or the case is not sound; nothing has been written.
    """
    return parse_case(case_data(Path(path), overrides))


def case_data(
    path: Path, overrides: Sequence[str], values: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """What stands in a case file, changed by overrides and values of dotted keys, its paths absolute.

    Raises InputError.
    """
    data = read_toml(path)
    if not data:
        raise InputError(f"{path}: the case is empty; give at least name, [fluid] and [domain]")
    for text in overrides:
        override(data, text)
    for key, value in (values or {}).items():
        _put(data, key, deepcopy(value), f"{key}={toml_text(value)}")
    _check_model(path, data.get("model", MODELS[0]))
    for section, key, value in _paths(data):
        data[section][key] = str((path.parent / value).resolve())
    if isinstance(data.get("bodies_from"), str):
        data["bodies_from"] = str((path.parent / data["bodies_from"]).resolve())
    for shape in _shapes(data):
        if isinstance(shape.get("points"), str):
            shape["points"] = str((path.parent / shape["points"]).resolve())
    return data


def _shapes(data: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """The tables of the shapes of bodies in the data of a case."""
    bodies = data.get("bodies", ())
    for body in bodies if isinstance(bodies, list) else ():
        shape = body.get("shape") if isinstance(body, dict) else None
        if isinstance(shape, dict):
            yield shape


def saved_data(data: Mapping[str, Any], path: Path) -> None:
    """Write a case file with these data, its paths seen from its folder. Raises InputError."""
    write_whole(path, case_text(data, path))


def case_text(data: Mapping[str, Any], path: Path) -> str:
    """What stands in a case file with these data at that path: paths in it are seen from its folder."""
    seen = deepcopy(dict(data))
    for section, key, value in _paths(data):
        seen[section][key] = os.path.relpath(value, path.parent)
    if "bodies_from" in data:
        seen["bodies_from"] = os.path.relpath(data["bodies_from"], path.parent)
    return tomli_w.dumps(seen)


def toml_values(text: str) -> list[Any]:
    """The values in `1, 2.5`, `[0.0, 1.0], [0.0, 2.0]` or, words without quotes, `square, rows`.

    Raises ValueError: it is no TOML.
    """
    words = [word.strip() for word in text.split(",")]
    if all(re.fullmatch(_WORD, word) for word in words) and not {"true", "false", "inf", "nan"} & set(words):
        return list(words)
    values: list[Any] = plain(tomllib.loads(f"values = [{text}]"))["values"]
    return values


def parse_case(data: Mapping[str, Any]) -> Case:
    """The case that nested dictionaries, lists and numbers describe, checked. Raises InputError."""
    geometry = data.get("geometry", "planar")
    if geometry not in get_args(Geometry.__value__):
        geometry = "planar"  # the schema says what is wrong
    members = with_grids(with_arrangement(data), CaseContext(geometry))
    listed = with_bodies(members, tuple(Body.model_fields))
    bodies = listed.get("bodies", ())
    context = CaseContext(geometry, len(bodies) if isinstance(bodies, tuple | list) else 0)
    try:
        case = Case.model_validate({"discretisation": {}} | tuples(listed), context=context)
    except ValidationError as error:
        raise InputError(explain(error, Case, listed)) from None
    check_case(case)
    return case


def read_toml(path: Path) -> dict[str, Any]:
    """The data of a case file. Raises InputError."""
    return toml_data(path, "a case file, `fsi cases` writes some")


def _check_model(path: Path, model: Any) -> None:
    """Raise InputError if there is no such level."""
    if model == "limit":
        raise InputError(
            f'{path}: model = "limit": is now `fsi limit` of a case of one gluey body; give "gluey"'
        )
    if model not in MODELS:
        choices = " or ".join([", ".join(f'"{name}"' for name in MODELS[:-1]), f'"{MODELS[-1]}"'])
        raise InputError(f"{path}: model = {toml_text(model)}: there is no such model; give {choices}")


_LAW_KEYS = ("law", "wall_law", "shear_law", "wall_shear_law", "rotation_law", "wall_rotation_law")
# Keys that are paths of files, seen from the folder of the case; words without a suffix are none.
_PATHS: dict[str, tuple[str, ...]] = {"domain": ("mesh",), "reduced": (*_LAW_KEYS, "drag_from")}


def _paths(data: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Section, key and value of each of these in the data of a case."""
    for name, keys in _PATHS.items():
        section = data.get(name)
        given = section if isinstance(section, dict) else {}
        for key in keys:
            value = given.get(key)
            if isinstance(value, str) and (key == "mesh" or Path(value).suffix):
                yield name, key, value


def named_files(data: Mapping[str, Any]) -> Iterator[tuple[str, Path]]:
    """The dotted keys of a case that are files, in the data of `Case.as_data`, and their paths."""
    return ((f"{section}.{key}", Path(value)) for section, key, value in _paths(data))


_REMEDY = "write key=value, for instance --set discretisation.degree=2"

_QUOTED = 'domain.mesh="mine.msh"'
_WORD = r"[A-Za-z][\w-]*"


def override(data: dict[str, Any], text: str) -> None:
    """Set one value in the nested data of a case file, in place; if the key is known is checked later.

    text: `key=value`; the key is dotted, bodies count from 0 (`bodies.0.radius`); the value is TOML, where a
    single word needs no quotes. Raises InputError: no `=`, no TOML, or a key that leads through no section.
    """
    key, separator, value = (part.strip() for part in text.partition("="))
    if not (key and separator):
        raise InputError(f"--set {text}: no key=value; {_REMEDY}")
    _put(data, key, _toml_value(value, text), text)


def _put(data: dict[str, Any], key: str, value: Any, text: str) -> None:
    """Give a dotted key its value, in place; text: what the user wrote. Raises InputError."""
    *path, last = key.split(".")
    here: Any = data
    for depth, part in enumerate(path):
        here = _enter(here, part, ".".join(path[: depth + 1]), text)
    if isinstance(here, dict):
        here[last] = value
    else:
        here[_index(here, last, key, text)] = value


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
        parsed = plain(tomllib.loads(f"value = {value}"))
    except (ValueError, RecursionError):
        if re.fullmatch(_WORD, value):
            return plain(value)
        parsed = {}
    if set(parsed) != {"value"}:
        raise InputError(f"--set {text}: the value is not TOML; {_REMEDY}, or '{_QUOTED}' for other text")
    return parsed["value"]
