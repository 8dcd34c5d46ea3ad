"""Files that appear complete or not at all."""

from __future__ import annotations

import os
from pathlib import Path

TEMPORARY = ".tmp"


def replace(path: Path, content: bytes) -> None:
    """Give a file new content in one go: whoever reads it sees the old or the new one."""
    temporary = path.with_name(path.name + TEMPORARY)
    with temporary.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    temporary.replace(path)
