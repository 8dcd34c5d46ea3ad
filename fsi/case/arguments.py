"""What Python users give to functions: of the right type, the same on all ranks, or refused in one line."""

from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from fsi.case.case import Case
from fsi.errors import InputError
from fsi.parallel import require_same, together_in_turn


def require_type(what: str, given: object, remedy: str, *, right: bool) -> None:
    """Raise InputError, which names the type of what is given, unless it is right."""
    if not right:
        raise InputError(f"{what}: is of type {type(given).__name__}; {remedy}")


def require_case(case: Case) -> None:
    """Raise InputError unless it is a case, the same on all ranks."""
    remedy = "give fsi.load_case(PATH) or fsi.make_case(...)"
    require_type("case", case, remedy, right=isinstance(case, Case))
    require_same("case", lambda: case.model_dump_json().encode())


def path_of(what: str, given: Path | str) -> Path:
    """The path. Raises InputError: it is none, or has a zero byte."""
    require_type(what, given, "give a path", right=isinstance(given, str | PathLike))
    if "\0" in str(path := Path(given)):
        raise InputError(f"{what} = {str(given)!r}: has a zero byte; give a path without")
    return path


def same_folder(folder: Path | str) -> Path:
    """The path of a folder. Raises InputError: it is none, or ranks differ in it."""
    path = path_of("folder", folder)
    require_same("folder", str(path).encode)
    return path


@contextmanager
def told_as(argument: str) -> Iterator[None]:
    """Let refusals of a path name an argument, where they name what commands call it: output, run."""
    try:
        yield
    except InputError as error:
        option, equals, rest = str(error).partition(" = ")
        if option not in ("output", "run"):
            raise
        raise InputError(f"{argument}{equals}{rest}") from error


@contextmanager
def of_folder() -> Iterator[None]:
    """What users call with the argument `folder`, all ranks together."""
    with together_in_turn(), told_as("folder"):
        yield


def lists(value: Any) -> Any:
    """The same data with lists and numbers of Python for arrays of any kind, and texts for paths.

    Raises InputError: they contain themselves.
    """
    try:
        return _lists(value)
    except RecursionError:
        raise InputError("case: a section contains itself; give sections as in a case file") from None


def _lists(value: Any) -> Any:
    match value:
        case dict():
            return {key: _lists(item) for key, item in value.items()}
        case list() | tuple():
            return [_lists(item) for item in value]
        case PathLike():
            return str(value)
        case np.ndarray() | np.generic():
            return _lists(value.tolist()) if value.dtype == object else value.tolist()
        case _ if hasattr(value, "__array__"):  # a column of pandas, a masked array
            return _lists(np.asarray(value))
        case _:
            return value
