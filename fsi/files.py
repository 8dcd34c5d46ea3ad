"""Files that appear complete or not at all, and where those that the user asks for may be."""

import os
from pathlib import Path

from fsi.errors import InputError

TEMPORARY = ".tmp"


def replace(path: Path, content: bytes) -> None:
    """Give a file new content in one go: whoever reads it sees the old or the new one."""
    temporary = path.with_name(path.name + TEMPORARY)
    with temporary.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    temporary.replace(path)


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
