"""Files that appear complete or not at all, where users may have theirs, and how those are read."""

import csv
import hashlib
import io
import json
import math
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path
from typing import Any

from fsi.errors import InputError

TEMPORARY = ".tmp"
# Of lists and sections in each other, in files of data: far more than any has.
_DEEPEST = 40
_BRIEF = 300  # letters of what a library says of a file
_WHOLE = 2**63  # whole numbers are smaller, as in TOML


def replace(path: Path, content: bytes) -> None:
    """Give a file new content in one go: whoever reads it sees the old or the new one."""
    with _becoming(path, path.with_name(path.name + TEMPORARY)) as temporary:
        temporary.write_bytes(content)


def appearing(path: Path) -> AbstractContextManager[Path]:
    """A path to write a file to, which then takes its place, with its content on the disk.

    Where that fails nothing is left of it, and what was there before stays.
    """
    return _becoming(path, unfinished(path))


def unfinished(path: Path) -> Path:
    """Where this process writes what then takes a path: a place of its own, as another may write the same."""
    return path.with_name(f".partial-{os.getpid()}-{path.name}")


@contextmanager
def _becoming(path: Path, temporary: Path) -> Iterator[Path]:
    """The second path, whose file is then that of the first."""
    try:
        yield temporary
        with temporary.open("rb") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
    except BaseException:
        with suppress(OSError):  # what the disk has refused already is told
            temporary.unlink()
        raise


def require_suffix(output: Path, *suffixes: str) -> None:
    """Raise InputError unless the path ends in one of them and its folder is there."""
    if output.suffix not in suffixes or not output.absolute().parent.is_dir():
        kinds = " or ".join(filter(None, [", ".join(suffixes[:-1]), suffixes[-1]]))
        raise InputError(f"output = {output}: give the path of a {kinds} file in a folder that exists")


def require_new(folder: Path, remedy: str = "give another folder") -> None:
    """Raise InputError, with the remedy, of what is there, unless it is an empty folder."""
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise InputError(f"output = {folder}: exists and is not empty; {remedy}")


def require_folder(folder: Path) -> None:
    """Raise InputError where no file can be written into a folder, or where it will be made."""
    folder = folder.absolute()
    there = next(path for path in (folder, *folder.parents) if path.exists())
    try:
        with tempfile.TemporaryFile(dir=there):
            pass
    except OSError as error:
        raise InputError(f"output = {folder}: {error.strerror}; give a folder that can be written") from None


def write_whole(output: Path, text: str) -> None:
    """Write a text; what was there before stays until it is complete. Raises InputError."""
    try:
        replace(output, text.encode())
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror}; give another path") from None


def content(path: Path, remedy: str) -> bytes:
    """What a file holds. Raises InputError, with the remedy: it cannot be read, or is a pipe or a device."""
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise InputError(f"{path}: is no regular file; {remedy}")
        return path.read_bytes()
    except (OSError, ValueError) as error:  # the latter of a path with a zero byte
        raise InputError(f"{path}: {getattr(error, 'strerror', None) or error}; {remedy}") from None


def data_of(path: Path, kind: str, parse: Callable[[str], Any], remedy: str) -> Any:
    """The data of a text file of some kind, TOML or JSON, as `parse` reads it. Raises InputError."""
    text = content(path, remedy)
    try:
        return plain(parse(text.decode("utf-8-sig")))
    except ValueError as error:  # of TOML, JSON, UTF-8, and numbers of thousands of digits
        raise InputError(
            f"{path}: not {kind}: {' '.join(str(error).split())[:_BRIEF]}; correct the file there"
        ) from None
    except RecursionError:
        raise InputError(f"{path}: not {kind}: nested too deeply; correct the file") from None


def json_of(path: Path, remedy: str) -> Any:
    """The data of a JSON file. Raises InputError."""
    return data_of(path, "JSON", json.loads, remedy)


def json_text(data: Any, indent: int | None = None) -> str:
    """Data as JSON, which has neither NaN nor infinite numbers: null for these."""
    return json.dumps(_finite(data), indent=indent)


def csv_text(rows: Iterable[Sequence[object]]) -> str:
    """Rows as CSV, the first of them a header; numbers have all their digits."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def csv_of(records: Sequence[Mapping[str, object]]) -> str:
    """Records of the same keys as CSV, with the keys as its header."""
    keys = list(records[0])
    return csv_text([keys, *([record[key] for key in keys] for record in records)])


def digest_of(data: Any) -> str:
    """A hash of data that JSON can hold, whatever the order of their keys."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()[:32]


def _finite(data: Any) -> Any:
    match data:
        case dict():
            return {key: _finite(item) for key, item in data.items()}
        case list() | tuple():
            return [_finite(item) for item in data]
        case float() if not math.isfinite(data):
            return None
    return data


def plain(data: Any, depth: int = 0) -> Any:
    """The same data. Raises ValueError of what nobody means: huge whole numbers, deep nesting, no text."""
    if depth > _DEEPEST:
        raise ValueError("nested too deeply")
    match data:
        case dict() | list() | tuple():
            for item in (*data, *data.values()) if isinstance(data, dict) else data:
                plain(item, depth + 1)
        case int() if not -_WHOLE <= data < _WHOLE:
            raise ValueError("a whole number has more than 64 bits")
        case str() if "\0" in data:
            raise ValueError("a text has a zero byte")
        case str():
            data.encode()  # or it has half a character
    return data
