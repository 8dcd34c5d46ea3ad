"""How a mistake in a case file becomes one line for the user: key, value, what is wrong, what to do."""

from collections.abc import Mapping
from typing import Any, Literal, get_args, get_origin

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from fsi.case.section import Section, sections_in, toml_text, words_like
from fsi.errors import InputError

_COMPLAINTS = {
    "literal_error": "not one of the choices",
    "model_type": "not a section",
    "dict_type": "not a section",
    "string_pattern_mismatch": "not of that form",
}
_CONSEQUENCES = ("default_factory_not_called",)  # of another mistake in the same section


def explain(
    error: ValidationError, root: type[Section], data: Mapping[str, Any], above: tuple[int | str, ...] = ()
) -> str:
    """The first mistake in the data as `key = value: what is wrong; what to do`, and how many others.

    above: where the root stands in the case file, of a section that is looked at by itself.
    """
    found = [mistake for mistake in error.errors(include_url=False) if mistake["type"] not in _CONSEQUENCES]
    # An old file has many mistakes, and its old keys explain the others.
    found.sort(key=lambda mistake: mistake["type"] != "renamed_key")
    others = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    first = found[0]
    return _explain_one(first, (*above, *first["loc"]), _meaning(first["loc"], root, data)) + others


def _explain_one(mistake: ErrorDetails, path: tuple[int | str, ...], meaning: str) -> str:
    given = mistake["input"]
    if mistake["type"] == "renamed_key":
        key, now = mistake["ctx"]["key"], mistake["ctx"]["now"]
        return f"{dotted((*path, key))} = {toml_text(given[key])}: an old key; {now}"
    if mistake["type"] == "unknown_key":
        key = mistake["ctx"]["key"]
        known = ", ".join(dotted((*path, word)) for word in mistake["ctx"]["known"])
        remedy = f"use {known} or drop it" if known else "drop it"
        return f"{dotted((*path, key))} = {toml_text(given[key])}: unknown key; {remedy}"
    if mistake["type"] in ("unknown_word", "unfit_key"):
        key, remedy = mistake["ctx"]["key"], mistake["ctx"]["remedy"]
        return f"{dotted((*path, key))} = {toml_text(given[key])}: {mistake['msg']}; {remedy}"
    if mistake["type"] == "missing":
        return f"{dotted(path)}: missing; give {meaning}"
    complaint = f"{dotted(path)} = {toml_text(given)}: {_complaint(mistake)}"
    has_remedy = mistake["type"] == "value_error" and "; " in mistake["msg"]
    return complaint if has_remedy else f"{complaint}; give {meaning}"


def _complaint(mistake: ErrorDetails) -> str:
    """Pydantic's words in those of a case file."""
    if mistake["type"] in _COMPLAINTS:
        return _COMPLAINTS[mistake["type"]]
    complaint = mistake["msg"].removeprefix("Value error, ").replace("valid tuple", "list")
    complaint = complaint.replace(" after validation", "")
    for subject in ("Input should", "Tuple should", "String should"):
        complaint = complaint.replace(subject, "must")
    return complaint


def dotted(path: tuple[int | str, ...]) -> str:
    """The key as `--set` takes it: `bodies.0.radius`."""
    return ".".join(str(part) for part in path if not str(part).startswith("<")) or "case"


def require_known(key: str, root: type[Section], text: str) -> None:
    """Raise InputError, with the one that is like it, of a dotted key that no section at its place has.

    text: the option that the user wrote. Names, as those of walls, are left to who reads them.
    """
    sections, above = [root], ""
    for part in key.split("."):
        fields = [each.model_fields[part] for each in sections if part in each.model_fields]
        if not (fields or part.isdigit()):
            known = words_like(part, dict.fromkeys(name for each in sections for name in each.model_fields))
            nearest = ", ".join(above + word for word in known)
            raise InputError(f"{text}: unknown key; use {nearest} or drop it")
        kinds = [field.annotation for field in fields]
        sections = [each for kind in kinds for each in sections_in(kind)] if fields else sections
        if not sections or any(get_origin(kind) is dict for kind in kinds):
            return
        above += f"{part}."


def choices_of(key: str, root: type[Section]) -> tuple[Any, ...]:
    """What may stand at a dotted key that takes one of some words or numbers; nothing of other keys."""
    sections, kinds = [root], list[Any]()
    for part in key.split("."):
        kinds = [each.model_fields[part].annotation for each in sections if part in each.model_fields]
        sections = sections if part.isdigit() else [each for kind in kinds for each in sections_in(kind)]
    return tuple(word for kind in kinds if get_origin(kind) is Literal for word in get_args(kind))


def _meaning(path: tuple[int | str, ...], root: type[Section], data: Mapping[str, Any]) -> str:
    """What the schema says that the key at `path` means: the description of the last field on the way.

    Of sections that may stand at one place it is that which the data there fit.
    """
    candidates, here = [root], data
    meaning = "a value that is allowed there"
    for part in path:
        here = _inside(here, part)
        for section in candidates:
            if str(part) in section.model_fields:
                meaning = section.describe(str(part)) or meaning
                inner = sections_in(section.model_fields[str(part)].annotation)
                candidates = [one.meant_by(here) for one in inner]
                break
    return " ".join(meaning.split())


def _inside(data: Any, part: int | str) -> Any:
    """What stands at a part of a key: the data themselves at one that only tells alternatives apart."""
    match data:
        case Mapping():
            return data.get(part, data)
        case list() | tuple() if isinstance(part, int) and part < len(data):
            return data[part]
        case _:
            return data
