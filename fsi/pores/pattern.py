"""Which unknowns meet in a pore, and the triangle of a symmetric matrix to which forms of pores are added.

A member of a pore is a surface or a neck, whose unknowns follow each other. Of members that meet all unknowns
meet: a row of the matrix is made of pieces, one for each member that its own one meets. Forms are symmetric:
rows end at the diagonal, and the members listed are those up to the own one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array, Indices
from fsi.machine.compiled import compiled, internal

type Short = NDArray[np.int32]

_MEMBERS = 6  # of a pore: three surfaces and three necks, -1 for none


class Pattern(NamedTuple):
    """The pattern of all members.

    Attributes:
        start: first unknown of each member, and their end, (n + 1,).
        first: where the list of those that each member meets begins, (n + 1,).
        other: these lists, ascending, of those before the member and itself.
        place: how many unknowns come before, of those listed.
        indptr: of rows up to the diagonal, as SciPy has it.
        indices: of columns.
    """

    start: Indices
    first: Indices
    other: Indices
    place: Indices
    indptr: Short
    indices: Short

    def matrix(self, data: Array) -> sp.csr_matrix:
        """The lower triangle with these entries."""
        n = int(self.start[-1])
        return sp.csr_matrix((data, self.indices, self.indptr), shape=(n, n))


def pattern_of(members: Indices, start: Indices) -> Pattern:
    """The pattern of pores with these members, (E, 6)."""
    first, other = _meetings(members, len(start) - 1)
    size = np.diff(start)
    before = np.cumsum(size[other]) - size[other]
    place = before - np.repeat(before[first[:-1]], np.diff(first))
    row = 1 + np.arange(start[-1]) + np.repeat(place[first[1:] - 1] - start[:-1], size)
    indptr = np.concatenate([[0], np.cumsum(row)]).astype(np.int32)
    return Pattern(start, first, other, place, indptr, _columns(start, first, other, int(indptr[-1])))


@compiled
def _meetings(members: Indices, count: int) -> tuple[Indices, Indices]:
    """Whom of those up to it each member meets: where its list begins, and the lists."""
    at = np.zeros(count + 1, np.int64)
    for pore in members:
        for i in range(_MEMBERS):
            if pore[i] >= 0:
                at[pore[i] + 1] += 1
    at = np.cumsum(at)
    pores, filled = np.empty(at[-1], np.int64), at.copy()
    for e in range(len(members)):
        for i in range(_MEMBERS):
            member = members[e, i]
            if member >= 0:
                pores[filled[member]] = e
                filled[member] += 1
    first, other, n = np.zeros(count + 1, np.int64), np.empty(_MEMBERS * at[-1] + count, np.int64), 0
    for member in range(count):
        begin = n
        n = _put_in_order(other, begin, n, member)
        for p in range(at[member], at[member + 1]):
            for i in range(_MEMBERS):
                if 0 <= members[pores[p], i] < member:
                    n = _put_in_order(other, begin, n, members[pores[p], i])
        first[member + 1] = n
    return first, other[:n].copy()


@internal
def _put_in_order(numbers: Indices, begin: int, end: int, number: int) -> int:
    """Put a number into an ascending list unless it is there; the new end."""
    p = end
    while p > begin and numbers[p - 1] > number:
        p -= 1
    if p > begin and numbers[p - 1] == number:
        return end
    for q in range(end, p, -1):
        numbers[q] = numbers[q - 1]
    numbers[p] = number
    return end + 1


@compiled
def _columns(start: Indices, first: Indices, other: Indices, entries: int) -> Short:
    """The columns of all rows, up to the diagonal."""
    columns, n = np.empty(entries, np.int32), 0
    for member in range(len(first) - 1):
        for row in range(start[member], start[member + 1]):
            for p in range(first[member], first[member + 1]):
                for column in range(start[other[p]], min(start[other[p] + 1], row + 1)):
                    columns[n] = column
                    n += 1
    return columns


@compiled
def add_forms(data: Array, pattern: Pattern, members: Indices, forms: Array) -> None:
    """Add the symmetric forms (n, m, m) of pores with these members, (n, .), to the entries of the triangle.

    A member that comes twice in a pore meets itself: both of its pieces are added to the one on the diagonal.
    """
    for e in range(len(members)):
        row = 0
        for member in members[e]:
            if member < 0:
                continue
            size, column = pattern.start[member + 1] - pattern.start[member], 0
            for other in members[e]:
                if other < 0:
                    continue
                width = pattern.start[other + 1] - pattern.start[other]
                if other <= member:
                    piece = forms[e, row : row + size, column : column + width]
                    _add_piece(data, pattern, (member, other), piece)
                column += width
            row += size


@internal
def _add_piece(data: Array, pattern: Pattern, pair: tuple[int, int], piece: Array) -> None:
    """Add what a member and one up to it have of a form; of one with itself the triangle."""
    member, other = pair
    p = pattern.first[member]
    while pattern.other[p] != other:
        p += 1
    for a in range(len(piece)):
        at = pattern.indptr[pattern.start[member] + a] + pattern.place[p]
        for b in range(a + 1 if other == member else piece.shape[1]):
            data[at + b] += piece[a, b]
