"""What goes wrong while a mesh is made, moved or read."""

from collections.abc import Iterable
from typing import ClassVar


class MeshError(Exception):
    """A mesh could not be made, or was refused: the message names the place and the remedy."""


def at(x: Iterable[float]) -> str:
    """A place as messages give it: (1.5, 2)."""
    return f"({', '.join(f'{c:.6g}' for c in x)})"


class MeshFileError(MeshError):
    """A mesh file cannot be read or written: the user's input is wrong."""

    exit_code: ClassVar[int] = 2
