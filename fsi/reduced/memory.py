"""The memory of the distance schemes: for each pair its own distance and what drives it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.bodies.gaps import row_numbers


@dataclass(frozen=True, slots=True)
class Memory:
    """What is stored of P pairs.

    key: see `Pairs`, (P, 2 + k); x: ln D; w: the first integral `D' + g K(D)`, with "backward-euler" D'
    itself; force: lambda at the end of the last step; all (P,).
    """

    key: NDArray[np.int64]
    x: Array
    w: Array
    force: Array

    def arrays(self) -> dict[str, NDArray[Any]]:
        """For the checkpoint."""
        return {"key": self.key, "x": self.x, "w": self.w, "force": self.force}

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> Self:
        """From the checkpoint."""
        return cls(arrays["key"], arrays["x"], arrays["w"], arrays["force"])

    def positions(self, keys: NDArray[np.int64]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Where the rows that both have stand in `keys` and in the memory; rows are distinct."""
        rows, own = row_numbers(keys, self.key)
        _, here, there = np.intersect1d(rows, own, assume_unique=True, return_indices=True)
        return here, there


def merged(key: NDArray[np.int64], *parts: tuple[NDArray[np.intp], NDArray[np.intp], Memory]) -> Memory:
    """The memory of the pairs with these keys, of parts (rows of the result, rows of the memory, memory)."""
    x, w, force = (np.empty(len(key)) for _ in range(3))
    for rows, where, memory in parts:
        x[rows], w[rows], force[rows] = memory.x[where], memory.w[where], memory.force[where]
    return Memory(key, x, w, force)
