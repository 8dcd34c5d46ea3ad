"""Files that the user has asked for: where they may be, and how they are written."""

from __future__ import annotations

from pathlib import Path

from fsi.errors import InputError
from fsi.files import replace


def require_suffix(output: Path, *suffixes: str) -> None:
    """Raise InputError unless the path ends in one of them and its folder is there."""
    if output.suffix not in suffixes or not output.absolute().parent.is_dir():
        kinds = " or ".join(filter(None, [", ".join(suffixes[:-1]), suffixes[-1]]))
        raise InputError(f"output = {output}: give the path of a {kinds} file in a folder that exists")


def write_whole(output: Path, text: str) -> None:
    """Write a text; what was there before stays until it is complete. Raises InputError."""
    try:
        replace(output, text.encode())
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror}; give another path") from None
