"""The keys of the case file, section by section, from the schema: what `fsi keys` prints."""

import inspect
import types
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from fsi.case.arranged import Arranged
from fsi.case.case import Case
from fsi.case.grids import Grid
from fsi.case.section import Section, sections_in, toml_text
from fsi.integration.schemes import SCHEMES
from fsi.lubrication.named_laws import LAWS


@dataclass(frozen=True, slots=True)
class Key:
    """One key: its name in the section, what it means, what holds if it is not given."""

    name: str
    meaning: str
    default: str


@dataclass(frozen=True, slots=True)
class SectionKeys:
    """One section: where it stands in the file, what it is for, its keys."""

    title: str
    purpose: str
    keys: tuple[Key, ...]


# Keys whose choices stand in registries, which grow by what is registered.
_CHOICES: Mapping[str, Iterable[str]] = {
    "time.scheme": [f"{kind.name} of order {kind.order}" for kind in SCHEMES.values()],
    "reduced.law": LAWS, "reduced.wall_law": LAWS,
    "reduced.shear_law": [name for name, law in LAWS.items() if "shear" in law.modes],
    "reduced.rotation_law": [name for name, law in LAWS.items() if "rotation" in law.modes],
}  # fmt: skip
# Sections that every case is given when it is read: their values depend on the case.
_ADDED = frozenset({"discretisation"})
# Where the schema has none: bodies are made of them when a case is read.
_INSTEAD: Mapping[str, type[Section]] = {"grids": Grid, "arrangement": Arranged}


def sections_of_case() -> list[SectionKeys]:
    """All sections of the case file, each once; the keys that stand above them come first."""
    return list(_walk(Case, "", "", set()))


def as_markdown(sections: list[SectionKeys]) -> str:
    """A table of the keys of each section."""
    lines: list[str] = []
    for section in sections:
        lines += [f"### {section.title or 'Above all sections'}", "", section.purpose, ""]
        lines += ["| key | meaning | if not given |", "|---|---|---|"]
        lines += [f"| `{key.name}` | {_cell(key.meaning)} | {_cell(key.default)} |" for key in section.keys]
        lines.append("")
    return "\n".join(lines)


def _cell(text: str) -> str:
    """A text in one line, as a row of a table has to be."""
    return " ".join(text.split()).replace("|", "\\|")


def _walk(section: type[Section], path: str, title: str, seen: set[type[Section]]) -> Iterator[SectionKeys]:
    """The section, then those that stand in it and have not been met before, like the table of a series."""
    seen.add(section)
    keys, inner = [], []
    for name, field in section.model_fields.items():
        here = f"{path}.{name}" if path else name
        in_it = [_INSTEAD[name]] if name in _INSTEAD else list(dict.fromkeys(sections_in(field.annotation)))
        meaning = section.describe(name) or ""
        keys.append(Key(name, _meaning(here, meaning), _default(here, field, meaning)))
        brackets = f"[[{here}]]" if name == "grids" or _is_list(field.annotation) else f"[{here}]"
        inner += [(each, here, f"`{brackets}`{_kind(each)}") for each in in_it]
    yield SectionKeys(title, inspect.getdoc(section) or "", tuple(keys))
    for each, here, its_title in inner:
        if each not in seen:
            yield from _walk(each, here, its_title, seen)


def _kind(section: type[Section]) -> str:
    """What tells this section from others in the same place: its shape or its law."""
    for key in ("shape", "law", "kind"):
        choices = get_args(section.model_fields[key].annotation) if key in section.model_fields else ()
        if len(choices) == 1:
            return f', `{key} = "{choices[0]}"`'
    return ""


def _is_list(annotation: Any) -> bool:
    if get_origin(annotation) in (Annotated, Union, types.UnionType):
        return any(map(_is_list, get_args(annotation)))
    return get_origin(annotation) is tuple


def _meaning(path: str, description: str) -> str:
    choices: Iterable[str] | None = _CHOICES.get(path)
    listed = "" if choices is None else f" ({', '.join(choices)})"
    return f"{description}{listed}"


def _default(path: str, field: FieldInfo, description: str) -> str:
    """The value as TOML, or what the description says of it."""
    if "if not given" in description:
        return "as it says"
    if path in _ADDED:
        return "its own defaults"
    if field.is_required():
        return "must be given"
    if field.default_factory is not None or field.default is None or field.default == ():
        return "none" if field.default is None else "its own defaults"
    return f"`{toml_text(field.default)}`"
