"""What goes wrong while a mesh is made, moved or read."""

from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from fsi.errors import InputError, SolveError


class MeshError(SolveError):
    """A mesh could not be made, or was refused: the message names the place and the remedy."""

    def __init__(self, message: str, *lengths: ArrayLike) -> None:
        """Places and lengths, if there are any, stand for the {} in the message."""
        self._message, self._lengths = message, lengths
        super().__init__(message.format(*map(at, lengths)) if lengths else message)

    def saying(self, more: str) -> Self:
        """The same with more words at its end, without braces."""
        return type(self)(self._message + more, *self._lengths)

    def in_units(self, unit: float, origin: ArrayLike = 0.0) -> Self:
        """The same with lengths times the unit that they were given in, and places from their origin."""
        lengths = (unit * np.asarray(length) for length in self._lengths)
        return type(self)(self._message, *(x + np.asarray(origin) if np.ndim(x) else x for x in lengths))


def at(x: ArrayLike) -> str:
    """A place as messages give it, (1.5, 2), or a length, 1.5."""
    numbers = [f"{c:.6g}" for c in np.ravel(x)]
    return f"({', '.join(numbers)})" if np.ndim(x) else numbers[0]


class TouchingError(MeshError):
    """Bodies, or a body and a wall, touch or overlap: no mesh would do."""


class MeshFileError(InputError):
    """A mesh file cannot be read or written."""
