"""What goes wrong while a mesh is made, moved or read."""

from typing import ClassVar


class MeshError(Exception):
    """A mesh could not be made, or was refused: the message names the place and the remedy."""


class MeshFileError(MeshError):
    """A mesh file cannot be read or written: the user's input is wrong."""

    exit_code: ClassVar[int] = 2
