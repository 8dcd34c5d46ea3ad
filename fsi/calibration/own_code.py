"""The code of users that a case is made of: sections that are registered from outside this package."""

import ast
import sys
from collections.abc import Iterator
from hashlib import sha256
from importlib.util import resolve_name
from pathlib import Path
from typing import Any
from uuid import uuid4

from fsi.case.case import Case
from fsi.case.section import Section


def own_code(case: Case) -> list[str]:
    """Hashes of the modules that define such sections, and of those beside them that they import.

    Of a module without a file, as in an interactive session, it is a new one each time: nothing tells
    whether it has been changed.
    """
    found, left = set[str](), [kind.__module__ for kind in _sections(case)]
    while left:
        name = left.pop()
        if _package(name) != _package(__name__) and name not in found:
            found.add(name)
            left += _beside(name)
    return [_digest(name) for name in sorted(found)]


def _sections(value: Any) -> Iterator[type[Section]]:
    """The sections in a value, with what they are derived from."""
    match value:
        case Section():
            yield from (base for base in type(value).__mro__ if issubclass(base, Section))
            yield from _sections([inner for _, inner in value])
        case dict():
            yield from _sections(list(value.values()))
        case list() | tuple():
            for inner in value:
                yield from _sections(inner)


def _beside(module: str) -> Iterator[str]:
    """The modules of the same package, or in the same folder, that one imports."""
    for name in _imports(module):
        if name in sys.modules and (_package(name) == _package(module) or _folder(name) == _folder(module)):
            yield name


def _imports(module: str) -> Iterator[str]:
    """What may be names of modules in its import statements."""
    file, package = _file(module), getattr(sys.modules.get(module), "__package__", None)
    for node in ast.walk(ast.parse(file.read_bytes())) if file and file.suffix == ".py" else ():
        match node:
            case ast.Import(names):
                yield from (alias.name for alias in names)
            case ast.ImportFrom(base, names, level):
                name = resolve_name("." * (level or 0) + (base or ""), package)
                yield from (name, *(f"{name}.{alias.name}" for alias in names))


def _package(module: str) -> str:
    return module.partition(".")[0]


def _folder(module: str) -> Path | None:
    return file.parent if (file := _file(module)) else None


def _file(module: str) -> Path | None:
    file = getattr(sys.modules.get(module), "__file__", None)
    return Path(file) if file and Path(file).is_file() else None


def _digest(module: str) -> str:
    return sha256(file.read_bytes()).hexdigest() if (file := _file(module)) else uuid4().hex
