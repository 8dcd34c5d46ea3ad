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

from fsi.case.arguments import lists, path_of
from fsi.case.body import Body
from fsi.case.case import MODELS, Case
from fsi.case.checks.sound import check_case
from fsi.case.complaints import explain, require_known
from fsi.case.magnitudes import GIVEN, check_magnitudes, check_whole_numbers
from fsi.case.reduced import LAW_KEYS
from fsi.case.section import CaseContext, Geometry, refusal, toml_data, toml_text, tuples
from fsi.errors import InputError
from fsi.files import plain, write_whole


def load_case(path: Path | str, overrides: Sequence[str] = ()) -> Case:
    """Read a case file; overrides are `key=value`, a dotted key (`bodies.0.radius=2`) and TOML, in order.

    Raises InputError: the file cannot be read or the case is not sound; nothing has been written.
    """
    return parse_case(case_data(path_of("path", path), overrides))


def make_case(**sections: Any) -> Case:
    """A case built in Python: the sections of a case file as keywords, dictionaries, lists and arrays.

        fsi.make_case(name="disc", fluid={"viscosity": 1.0}, domain={...}, bodies=[{...}])

    Raises InputError: it is not sound, in one line that names the key.
    """
    return parse_case(lists(sections))


def case_data(
    path: Path, overrides: Sequence[str], values: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """What stands in a case file, changed by overrides and values of dotted keys, its paths absolute.

    Raises InputError.
    """
    data = read_toml(path)
    if not data:
        raise InputError(f"{path}: the case is empty; give at least name, [fluid] and [domain]")
    listed = isinstance(overrides, Sequence) and not isinstance(overrides, str)
    if not listed or not all(isinstance(text, str) for text in overrides):
        raise InputError(f'overrides = {overrides!r}: give a list of texts, ["time.end=20"]')
    for text in overrides:
        override(data, text)
    for key, value in (values or {}).items():
        _put(data, key, deepcopy(value), f"--vary {key}={toml_text(value)}")
    for _, table, last in _paths(data):
        # Where links lead in a circle `Path.resolve` would raise; who reads the file tells of it.
        table[last] = os.path.realpath(path.parent / table[last])
    return data


def saved_data(data: Mapping[str, Any], path: Path) -> None:
    """Write a case file with these data, its paths seen from its folder. Raises InputError."""
    write_whole(path, case_text(data, path))


def case_text(data: Mapping[str, Any], path: Path) -> str:
    """What stands in a case file with these data at that path: paths in it are seen from its folder."""
    seen = deepcopy(dict(data))
    for _, table, last in _paths(seen):
        table[last] = os.path.relpath(table[last], path.parent)
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
    _check_model(data.get("model", MODELS[0]))
    geometry = data.get("geometry", "planar")
    if geometry not in get_args(Geometry.__value__):
        geometry = "planar"  # the schema says what is wrong
    check_magnitudes(data, GIVEN)
    check_whole_numbers(data)
    listed = _with_all_bodies(data, CaseContext(geometry))
    try:
        return _case_of(listed, geometry)
    except InputError as error:
        if str(error).startswith("bodies") and (told := _made(data, listed)):
            raise InputError(f"{error} ({told})") from None
        raise


def _made(data: Mapping[str, Any], listed: Mapping[str, Any]) -> str:
    """What messages that name bodies say of those that a section has made; nothing where none has."""
    if "arrangement" in data and "arrangement" not in listed:
        return "the bodies are those of [arrangement]"
    if "grids" in data and "grids" not in listed:
        from fsi.case.grids import members

        return members(data["grids"], len(data.get("bodies", ())))
    return ""


def _case_of(listed: Mapping[str, Any], geometry: Geometry) -> Case:
    """The case of data with all bodies in [[bodies]], checked. Raises InputError."""
    check_magnitudes(listed, ["bodies"])
    bodies = listed.get("bodies", ())
    context = CaseContext(geometry, len(bodies) if isinstance(bodies, tuple | list) else 0)
    try:
        case = Case.model_validate({"discretisation": {}} | tuples(listed), context=context)
    except ValidationError as error:
        raise InputError(explain(error, Case, listed)) from None
    check_case(case)
    return case


def _with_all_bodies(data: Mapping[str, Any], context: CaseContext) -> dict[str, Any]:
    """The data of a case with all its bodies in [[bodies]]: arranged ones, those of grids and of a file.

    What makes them is loaded where a case asks for it. Raises InputError.
    """
    listed = dict(data)
    if "arrangement" in listed:
        from fsi.case.arranged import with_arrangement

        listed = with_arrangement(listed)
    if "grids" in listed:
        from fsi.case.grids import with_grids

        listed = with_grids(listed, context)
    if not listed.keys().isdisjoint({"bodies_from", "body_defaults"}):
        from fsi.case.body_file import with_bodies

        listed = with_bodies(listed, tuple(Body.model_fields))
    return listed


def read_toml(path: Path) -> dict[str, Any]:
    """The data of a case file. Raises InputError."""
    return toml_data(path, "a case file, `fsi cases` writes some")


def _check_model(model: Any) -> None:
    """Raise InputError if there is no such level."""
    if model == "limit":
        raise refusal("model", model, 'is now `fsi limit` of a case of one gluey body; give "gluey"')
    if model not in MODELS:
        choices = " or ".join([", ".join(f'"{name}"' for name in MODELS[:-1]), f'"{MODELS[-1]}"'])
        raise refusal("model", model, f"there is no such model; give {choices}")


# Keys of sections that are paths of files; words without a suffix are laws that have a name.
_PATHS: dict[str, tuple[str, ...]] = {"domain": ("mesh",), "reduced": (*LAW_KEYS, "drag_from")}


def _paths(data: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any], str]]:
    """The dotted key of each path of a file in the data of a case, the table that has it, and its key there.

    These are the paths that are seen from the folder of the case file.
    """
    for name, keys in _PATHS.items():
        section: Any = data.get(name)
        for key in keys if isinstance(section, dict) else ():
            value = section.get(key)
            if isinstance(value, str) and (key == "mesh" or Path(value).suffix):
                yield f"{name}.{key}", section, key
    if isinstance(data.get("bodies_from"), str):
        yield "bodies_from", data, "bodies_from"
    listed = data.get("bodies")
    bodies = enumerate(listed if isinstance(listed, list | tuple) else ())
    for key, body in [("body_defaults", data.get("body_defaults")), *((f"bodies.{i}", b) for i, b in bodies)]:
        shape = body.get("shape") if isinstance(body, dict) else None
        if isinstance(shape, dict) and isinstance(shape.get("points"), str):
            yield f"{key}.shape.points", shape, "points"


def named_files(data: Mapping[str, Any]) -> Iterator[tuple[str, Path]]:
    """The dotted keys of all files that the data of a case name, and their paths.

    A file of bodies may name files in turn. Raises InputError: it cannot be read.
    """
    for key, table, last in _paths(dict(data)):
        yield key, Path(table[last])
        if key == "bodies_from":
            from fsi.case.body_file import read_bodies

            bodies = read_bodies(Path(table[last])).bodies
            yield from ((f"{key}.{inner}", path) for inner, path in named_files({"bodies": bodies}))


_REMEDY = "write key=value, for instance --set discretisation.degree=2"

_QUOTED = 'domain.mesh="mine.msh"'
_WORD = r"[A-Za-z][\w-]*"
_DROPPED = "none"  # as a bare word


def override(data: dict[str, Any], text: str) -> None:
    """Set one value in the nested data of a case file, in place; if the key is known is checked later.

    text: `key=value`; the key is dotted, bodies count from 0 (`bodies.0.radius`); the value is TOML, where a
    single word needs no quotes. With the word `none` the key is left out. Raises InputError: no `=`, no TOML,
    or a key that leads through no section.
    """
    key, separator, value = (part.strip() for part in text.partition("="))
    if not (key and separator):
        raise InputError(f"--set {text}: no key=value; {_REMEDY}")
    if value == _DROPPED and not key.rpartition(".")[2].isdigit():  # entries of lists have no default
        _leave_out(data, key, f"--set {text}")
    else:
        _put(data, key, _toml_value(value, text), f"--set {text}")


def _leave_out(data: dict[str, Any], key: str, text: str) -> None:
    """Take a dotted key out, in place, if it is there. Raises InputError: no section has such a key."""
    *path, last = key.split(".")
    here: Any = data
    for depth, part in enumerate(path):
        if isinstance(here, dict) and part not in here:
            here = {}
            break
        here = _enter(here, part, ".".join(path[: depth + 1]), text)
    if isinstance(here, list):
        _index(here, last, key, text)
    elif here.pop(last, None) is None:
        require_known(key, Case, text)


def _put(data: dict[str, Any], key: str, value: Any, text: str) -> None:
    """Give a dotted key its value, in place; text: the option that the user wrote. Raises InputError."""
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
        raise InputError(f"{text}: {key} = {toml_text(inner)} is no section; set {key} itself")
    return inner


def _index(items: list[Any], part: str, key: str, text: str) -> int:
    if part in map(str, range(len(items))):  # "01" would be a second name of an entry
        return int(part)
    there = f"has the entries 0 to {len(items) - 1}" if items else "is empty"
    raise InputError(f"{text}: no {key}; the list {there}")


def _toml_value(value: str, text: str) -> Any:
    try:
        parsed = plain(tomllib.loads(f"value = {value}"))
    except (ValueError, RecursionError) as error:
        if re.fullmatch(_WORD, value):
            return plain(value)
        if not isinstance(error, tomllib.TOMLDecodeError):  # whose places are not those in the text
            reason = " ".join(str(error).split())
            raise InputError(f"--set {text}: the value is not TOML: {reason}; correct it") from None
        parsed = {}
    if set(parsed) != {"value"}:
        raise InputError(f"--set {text}: the value is not TOML; {_REMEDY}, or '{_QUOTED}' for other text")
    return parsed["value"]
