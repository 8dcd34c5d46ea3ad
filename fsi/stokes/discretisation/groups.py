"""Elimination of the unknowns that stand in groups of cells alone, before MUMPS sees the matrix.

Cells that have a side in common are put together in pairs, some of these again in pairs, and so on up to
WIDEST unknowns. As the unknowns of a group are ordered as outer ones, which others have too, and inner ones,

    [ S_oo  S_oi ] = sum of what its two parts leave,      S = S_oo - S_oi S_ii^-1 S_io
    [ S_io  S_ii ]

is what it leaves in turn: nested dissection (George 1973, SIAM J. Numer. Anal. 10:345) from its leaves up,
of which MUMPS does the rest. Small dense matrices cost these loops a third of the time of its fronts.
Velocities of a body are eliminated with the last of its cells, but where inertia or laws come to them.

At first each part chooses the one beside it with which it shares most. After that pairs are put together one
by one, of all the one that grows least: by what it leaves less the mean of what both had. That takes as many
operations as MUMPS's approximate minimum fill, or fewer. At least two groups remain, or on several ranks one
of each, with what they share.

Of long domains that would grow groups whose borders wander: of 1000 discs in a channel 415 unknowns across it
where the shortest way through gaps and bodies has 265. So where more than MOST parts are left they are first
cut in regions of no more, each cut the least between the ends of what it cuts, which is where the greatest
flow between them is held up (Ford and Fulkerson 1956, Can. J. Math. 8:399); within regions they grow first.

No pivoting is needed. Velocities are eliminated first, whose block is positive definite. What is left of the
inner pressures p is regular: p vanishes where other groups begin, and if it met no inner velocity, then
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

from fsi.arrays import Array
from fsi.machine.heap import aligned
from fsi.stokes.discretisation.loops import Numbers, loops, pointer

LEVELS, FEWEST = 3, 512  # all parts choose so often at most, and only while there are so many of them
MOST = 1000  # parts of a region
WIDEST = 4000  # unknowns that a group leaves at most; those of 5000 discs leave fewer


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
        *,
        merged: bool,
    ) -> None:
        """Merge cells.

        cells: start and list of theirs, as above. rows: of the matrix of a cell. stays: unknowns that must be
        left. pressure: those that are pressures. merged: or else the cells are left alone.
        """
        lib, ffi = loops().lib, loops().ffi
        given: dict[str, NDArray[Any]] = {
            "start": cells[0],
            "list": cells[1],
            "stays": stays.view(np.int8),
            "pressure": pressure.view(np.int8),
        }
        held = {name: pointer(array) for name, array in given.items()}
        sizes = {"cells": len(cells[0]) - 1, "unknowns": len(stays), "rows": rows}
        lists = ffi.new("CellLists *", sizes | held)
        self.structure = ffi.gc(ffi.new("Groups *"), lib.free_groups)
        limits = {"levels": LEVELS, "fewest": FEWEST, "most": MOST, "widest": WIDEST} if merged else {}
        wanted = ffi.new("Wanted *", limits)
        if lib.merge_cells(lists, wanted, self.structure):
            raise MemoryError
        self.start: Numbers = np.empty(self.structure.groups + 1, dtype=np.int32)
        self.list: Numbers = np.empty(cells[0][-1], dtype=np.int32)
        self.left = np.ones(len(stays), dtype=bool)
        listed: tuple[NDArray[Any], ...] = (self.start, self.list, self.left.view(np.int8))
        lib.list_groups(lists, self.structure, *map(pointer, listed))
        self.list = self.list[: self.start[-1]].copy()
        self.factors: Array = np.empty(self.structure.factors[self.structure.merges])
        self.room: Array = aligned(lib.room_of_groups(lists, self.structure))

    def reduce(self, b: Array) -> None:
        """Give the loads b of all unknowns that are not left to those that are, in place."""
        loops().lib.reduce_groups(self.structure, pointer(self.factors), pointer(b))

    def recover(self, x: Array, b: Array) -> None:
        """Find the values x of those that are not left from the others, for loads that have been reduced."""
        loops().lib.recover_groups(self.structure, pointer(self.factors), pointer(b), pointer(x))
