"""Elimination of the unknowns that stand in groups of cells alone, before MUMPS sees the matrix.

Cells that have a side in common are put together in pairs, these again in pairs, and so on: 32 cells in five
levels. As the unknowns of a group are ordered as outer ones, which others have too, and inner ones,

    [ S_oo  S_oi ] = sum of what its two parts leave,      S = S_oo - S_oi S_ii^-1 S_io
    [ S_io  S_ii ]

is what it leaves in turn: nested dissection (George 1973, SIAM J. Numer. Anal. 10:345) from its leaves up,
of which MUMPS does the rest. Small dense matrices cost these loops a third of the time of its fronts.

No pivoting is needed. Velocities are eliminated first, whose block is positive definite. What is left of the
inner pressures p is regular: p vanishes on the sides to other groups, and if it met no inner velocity, then
on each side between two cells of the group, with its tangent t and w the product of the two barycentric
coordinates that do not vanish on it, v = w (t.grad p) t of degree k would give

    0 = int p div v = - int w (t.grad p)^2.

So p is constant along t in both cells: on one with a second such side it is constant, and on one with a side
to another group zero. A cell with two sides on boundaries has p = f(n.x), and zero in the next cell; then
v = w f' n, with w f'(0) n there, gives f = 0 too. So p is constant, and zero where the group meets another.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Array
from fsi.stokes.discretisation.loops import Numbers, loops, pointer

# Levels of pairs: with five or six a step of 200 discs costs least, and that of one disc hardly more.
LEVELS = 5
# Fewer parts are not merged: MUMPS finds a better order for what they leave, by so much that two discs would
# take a sixth longer.
FEWEST = 128
WIDE = 8  # entries of a row that the loops take at once


class Groups:
    """The unknowns that groups of cells leave, and the factors of those that one group has alone.

    Attributes:
        start, list: the unknowns that group g leaves are list[start[g] : start[g + 1]].
        left: which unknowns are left by any, and those that no cell has.
        structure: what the loops that add up cells take.
        factors: what they fill, rows of L and D of all merges.
        room: what they work in.
    """

    def __init__(
        self,
        cells: tuple[Numbers, Numbers],
        rows: int,
        stays: NDArray[np.bool_],
        pressure: NDArray[np.bool_],
        levels: int,
    ) -> None:
        """Merge cells.

        cells: start and list of theirs, as above. rows: of the matrix of a cell. stays: unknowns that must be
        left. pressure: those that are pressures. levels: 0 leaves the cells alone.
        """
        count, most = len(cells[0]) - 1, levels * int(cells[0][-1])
        lib, ffi = loops().lib, loops().ffi
        given: dict[str, NDArray[Any]] = {
            "start": cells[0],
            "list": cells[1],
            "stays": stays.view(np.int8),
            "pressure": pressure.view(np.int8),
        }
        held = {name: pointer(array) for name, array in given.items()}
        lists = ffi.new("CellLists *", {"cells": count, "unknowns": len(stays)} | held)
        of_merges = {name: np.empty(count + 1, dtype=np.int32) for name in ("start", "outer", "begin")}
        self._arrays: dict[str, NDArray[Any]] = of_merges | {
            "list": np.empty(most, dtype=np.int32), "slots": np.empty(most, dtype=np.int16),
            "factors": np.empty(count + 1, dtype=np.int64),
            "ends": np.empty(count, dtype=np.int32), "steps": np.empty(2 * count, dtype=np.int32),
        }  # fmt: skip
        self._pointers = {name: pointer(array) for name, array in self._arrays.items()}
        self.structure = ffi.new("Groups *", self._pointers)
        if lib.merge_cells(lists, levels, FEWEST, self.structure):
            raise MemoryError
        self._merges, groups = self.structure.merges, self.structure.groups
        self.start: Numbers = np.empty(groups + 1, dtype=np.int32)
        self.list: Numbers = np.empty(cells[0][-1], dtype=np.int32)
        lib.list_groups(lists, self.structure, pointer(self.start), pointer(self.list))
        self.list = self.list[: self.start[-1]].copy()
        self.left = self._left(len(stays))
        self.factors: Array = np.empty(self._arrays["factors"][self._merges])
        # A part of each level may wait; there are the last cell with what it was, and a merge with its rows.
        sizes = np.concatenate([np.diff(start) for start in (cells[0], self._of_merges("start", 1))])
        widest = -(-max(int(sizes.max(initial=1)), rows) // WIDE) * WIDE
        self.room: Array = np.empty((levels + 5) * widest**2)

    def _of_merges(self, name: str, more: int = 0) -> NDArray[Any]:
        return self._arrays[name][: self._merges + more]

    def _left(self, unknowns: int) -> NDArray[np.bool_]:
        start, left = self._of_merges("start", 1), np.ones(unknowns, dtype=bool)
        place = np.arange(start[-1]) - np.repeat(start[:-1], np.diff(start))
        inner = place >= np.repeat(self._of_merges("outer"), np.diff(start))
        left[self._arrays["list"][: start[-1]][inner]] = False
        return left

    def reduce(self, b: Array) -> None:
        """Give the loads b of all unknowns that are not left to those that are, in place."""
        loops().lib.reduce_groups(self.structure, pointer(self.factors), pointer(b))

    def recover(self, x: Array, b: Array) -> None:
        """Find the values x of those that are not left from the others, for loads that have been reduced."""
        loops().lib.recover_groups(self.structure, pointer(self.factors), pointer(b), pointer(x))
