"""P^T M P, straight from the matrices of single cells: M over all rows is never made.

With the rows T of P on a cell and its matrix S without inner unknowns (see `cells`),

    P^T M P = sum over cells of T^T S T,

where T picks unknowns, but for rows on bodies. Which entries of the sum each entry of a cell goes to is found
once for a mesh and its constraints, and kept while the mesh is moved. On several ranks each adds up its own
cells, and what entries on other ranks get from them is sent there. The rows of M that are constrained, from
which reactions come, are kept apart.
"""

from itertools import pairwise
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array, Indices
from fsi.stokes.discretisation.cells import StokesCells
from fsi.stokes.discretisation.constraints import Prolongation
from fsi.stokes.discretisation.groups import Groups
from fsi.stokes.discretisation.loops import Numbers, loops, pointer
from fsi.stokes.discretisation.nodal_matrix import NO_COLUMN
from fsi.stokes.discretisation.shared_rows import shared_columns
from fsi.stokes.solvers.mumps import Solve

# Unknowns of a cell beyond its outer rows: each of four vertices may bring six modes in place of three rows,
# and where fluid slides six modes beside them, and each node on a surface a normal traction.
MORE = 12


class ConstrainedRows:
    """The rows of M that are constrained; they have as many entries as the cells have there."""

    def __init__(self, cells: StokesCells, rows: Indices) -> None:
        """Collective. rows: this rank's that are constrained."""
        self._shared, self.rows = cells.shared, rows
        own = np.zeros(len(self._shared.own), dtype=bool)
        own[rows] = True
        constrained = self._shared.with_ghosts(own)
        cell, local = np.nonzero(constrained[cells.outer])
        row = cells.outer[cell, local]
        order = np.argsort(row, kind="stable")
        cell, local = cell[order], local[order]
        self._row, self._columns = row[order], np.ascontiguousarray(cells.rows[cell])
        self.places: Numbers = np.full(cells.outer.shape, -1, dtype=np.int32)
        self.places[cell, local] = np.arange(len(cell))
        self.values: Array = np.empty(self._columns.shape)

    def times(self, x: Array) -> Array:
        """M x on the constrained rows, in the precision of x; collective."""
        return self._product(x, transposed=False)[self.rows]

    def transpose_times(self, g: Array) -> Array:
        """M^T g on all rows of this rank for a g that is zero elsewhere; collective."""
        return self._product(g, transposed=True)

    def _product(self, x: Array, *, transposed: bool) -> Array:
        every, lib = self._shared.with_ghosts(x), loops().lib
        product = np.zeros_like(every)
        loop = lib.times_kept if x.dtype == np.float64 else lib.times_kept_extended
        arrays: tuple[NDArray[Any], ...] = (self._row, self._columns, self.values, every, product)
        loop(*self._columns.shape, int(transposed), *map(pointer, arrays))
        return self._shared.summed(product)


class CellSum:
    """P^T M P of the cells of a mesh, in place while that is moved, and the constrained rows of M.

    Attributes:
        matrix: P^T M P without what groups of cells have eliminated; all of its diagonal is stored.
        left: which of this rank's unknowns it is of; others may be eliminated by another rank.
        constrained: the other rows.
    """

    def __init__(
        self,
        cells: StokesCells,
        P: Prolongation,
        *,
        grouped: bool = False,
        apart: bool = False,
        stays: Indices | None = None,
    ) -> None:
        """Find the pattern, and fill it; collective.

        grouped: see `groups`. apart: whether each rank keeps what its own cells give, where products are all
        that is wanted: to send rows to their owners takes as long as to add up the cells. stays: columns of
        P, of any rank, that are left besides those that ranks share.
        """
        self._cells, self._P = cells, P
        self._apart = apart and P.matrix.comm.size > 1
        self.constrained = ConstrainedRows(cells, P.constrained)
        columns = cells.shared.with_ghosts(P.columns)
        self._numbered(columns)
        self._listed()
        self._grouped(np.empty(0, dtype=np.int64) if stays is None else stays, merged=grouped)
        self._patterned(coupled=cells.inner > 0 or grouped)
        self._values = np.empty(len(self._indices))
        self.matrix = self._created()
        self.fill()

    def _numbered(self, columns: Indices) -> None:
        """The unknowns that this rank's cells meet, and its own, get numbers from 0 on."""
        self._unknowns, self._shared = shared_columns(columns[columns != NO_COLUMN], self._P.here)
        number = np.full(self._P.matrix.size[1] + 1, NO_COLUMN, dtype=np.int32)
        number[self._unknowns] = np.arange(len(self._unknowns))
        self._columns: Numbers = number[columns]

    def _met(self, columns: Indices) -> Indices:
        """The numbers of those columns that this rank meets; they ascend."""
        number = np.searchsorted(self._unknowns, columns)
        number = number[number < len(self._unknowns)]
        return np.asarray(number[self._unknowns[number] == columns[: len(number)]])

    def _listed(self) -> None:
        """The unknowns of each cell."""
        cells, width = self._cells, self._columns.shape[1]
        count, outer = cells.outer.shape
        most = 2 * (outer + MORE) if self._P.sliding else outer + MORE
        self._start, self._list = np.empty(count + 1, np.int32), np.empty(count * most, np.int32)
        self._slots = np.empty((count, outer, width), dtype=np.int16)
        self._plain = np.empty(count, dtype=np.int8)
        self._weights = cells.shared.with_ghosts(self._P.weights)
        arrays: tuple[NDArray[Any], ...] = (
            cells.rows, self._columns, self._weights, self._start, self._list, self._slots, self._plain,
        )  # fmt: skip
        sizes = (count, cells.rows.shape[1], outer, width)
        self._most = loops().lib.list_unknowns(*sizes, *map(pointer, arrays))
        self._list = self._list[: self._start[-1]].copy()

    def _grouped(self, stay: Indices, *, merged: bool) -> None:
        """What groups of cells leave, which gets numbers of its own."""
        of_pressure = self._columns[self._cells.shared.pressures :, 0]
        pressure, stays = np.zeros(len(self._unknowns), dtype=bool), ~self._met_alone()
        pressure[of_pressure[of_pressure != NO_COLUMN]] = True
        stays[self._met(stay)] = True
        rows = self._cells.rows.shape[1]
        self._groups = Groups((self._start, self._list), rows, stays, pressure, merged=merged)
        left, shared = self._groups.left, self._shared
        self._foreign = np.zeros(len(left), dtype=bool)
        self._foreign[shared.ghosts] = ~left[shared.ghosts]
        self._lent = shared.summed(self._foreign.astype(np.int8)) > 0
        left[shared.own[self._lent]] = False
        self._pressure = pressure[left].astype(np.int8)
        self.left = shared.owned(left)
        number = np.cumsum(self.left) - 1
        number += MPI.COMM_WORLD.exscan(int(self.left.sum())) or 0
        self._numbers = shared.with_ghosts(number)[left].astype(PETSc.IntType)

    def _met_alone(self) -> NDArray[np.bool_]:
        """The unknowns that cells of this rank meet, and of no other one, be it that which owns them."""
        met = np.zeros(len(self._unknowns), dtype=np.int32)
        met[self._list] = 1
        ranks = self._shared.with_ghosts(self._shared.summed(met))
        return np.asarray((met == 1) & (ranks == 1))

    def _patterned(self, *, coupled: bool) -> None:
        """The columns of each row, and where each entry that a group leaves goes."""
        groups, unknowns = self._groups, len(self._numbers)
        start, left = groups.start, np.cumsum(groups.left, dtype=np.int32)[groups.list] - 1
        first, mark, self._indptr = (np.empty(unknowns + k, dtype=np.int32) for k in (1, 0, 1))
        place, cell = np.empty_like(left), np.empty_like(left)
        lib, ffi = loops().lib, loops().ffi
        lists = (start, left, first, place, cell)
        lib.list_meetings(len(start) - 1, unknowns, *map(pointer, lists))
        names = ("start", "list", "first", "place", "cell", "pressure")
        arrays: tuple[NDArray[Any], ...] = (*lists, self._pressure)
        held = {name: pointer(array) for name, array in zip(names, arrays, strict=True)}
        sizes = {"unknowns": unknowns, "coupled": int(coupled)}
        meetings = ffi.new("Meetings *", sizes | held)
        self._first = np.concatenate([[0], np.cumsum(np.diff(start).astype(np.int64) ** 2)])
        # There is room in it for the columns, until they are in order, and one of each that no cell meets.
        self._positions = np.empty(self._first[-1] + unknowns, dtype=np.int32)
        lib.gather_entries(meetings, *map(pointer, (mark, self._indptr, self._positions)))
        self._indices = np.empty(self._indptr[-1], dtype=np.int32)
        ordered = (self._indptr, self._positions, mark, self._indices)
        lib.sort_entries(unknowns, *map(pointer, ordered))
        pattern = (self._indptr, self._indices, self._first, mark, self._positions)
        lib.find_positions(meetings, *map(pointer, pattern))

    def _created(self) -> PETSc.Mat:
        """The matrix with room for this pattern; on one rank, and in parts, its values are these."""
        comm, here = self._P.matrix.comm, int(self.left.sum())
        csr, met = (self._indptr, self._indices, self._values), len(self._numbers)
        if comm.size == 1:
            return PETSc.Mat().createAIJWithArrays((here, here), csr, comm=comm)
        if self._apart:
            own = PETSc.Mat().createAIJWithArrays((met, met), csr, comm=PETSc.COMM_SELF)
            return _summed(own, self._numbers, here, comm)
        matrix = PETSc.Mat().createAIJ(size=((here, None), (here, None)), nnz=self._room(here), comm=comm)
        self._indices = self._numbers[self._indices]
        return matrix

    def _room(self, here: int) -> tuple[Numbers, Numbers]:
        """Entries of this rank's rows in its own columns and in others': at most, as ranks share some."""
        comm, unknowns = self._P.matrix.comm.tompi4py(), self._numbers
        starts = np.concatenate([[0], np.cumsum(comm.allgather(here))])
        parts = []
        for first, end in pairwise(np.searchsorted(unknowns, starts)):
            of_part = self._indices[self._indptr[first] : self._indptr[end]]
            inside = (of_part >= first) & (of_part < end)
            total = np.diff(self._indptr[first : end + 1])
            begin, some = self._indptr[first:end] - self._indptr[first], total > 0
            own = np.zeros_like(total)
            own[some] = np.add.reduceat(inside, begin[some], dtype=own.dtype)
            parts.append((unknowns[first:end], own, total - own))
        room = np.zeros((2, here), dtype=PETSc.IntType)
        for row, *counts in comm.alltoall(parts):
            room[:, row - starts[comm.rank]] += counts
        most = np.array([[here], [starts[-1] - here]], dtype=room.dtype)
        inside, outside = np.minimum(room, most)
        return inside, outside

    def fill(self) -> None:
        """Add up all cells with the mesh and the P of now; collective."""
        self._weights[:] = self._cells.shared.with_ghosts(self._P.weights)
        self._values[:] = 0.0
        arrays: dict[str, NDArray[Any]] = {
            "rows": self._cells.rows, "weights": self._weights, "start": self._start, "slots": self._slots,
            "plain": self._plain, "first": self._first, "positions": self._positions,
            "kept": self.constrained.places,
        }  # fmt: skip
        held: dict[str, Any] = {name: pointer(array) for name, array in arrays.items()}
        sizes = {"width": self._slots.shape[2], "most": self._most}
        sum_ = loops().ffi.new("Sum *", sizes | held)
        self._cells.add(sum_, self._groups, self._values, self.constrained.values)
        if self._apart:
            self.matrix.getISLocalMat().stateIncrease()
        elif self.matrix.comm.size == 1:
            self.matrix.stateIncrease()
        else:
            self.matrix.zeroEntries()
            csr = (self._indptr, self._indices, self._values)
            self.matrix.setValuesIJV(*csr, addv=PETSc.InsertMode.ADD_VALUES, rowmap=self._numbers)
        self.matrix.assemble()

    def solved(self, b: Array, solve: Solve) -> Array:
        """Solutions of P^T M P y = b for some columns b, by those of the matrix; collective."""
        loads = np.column_stack([self._reduced(load) for load in b.T])
        y = solve(self._shared.summed(loads)[self.left])
        return np.column_stack([self._recovered(*pair) for pair in zip(y.T, loads.T, strict=True)])

    def _reduced(self, b: Array) -> Array:
        """The loads of all unknowns that this rank's cells meet, those of inner ones given to the others."""
        every, ghosts = self._shared.with_ghosts(b), self._shared.ghosts
        every[ghosts] *= self._foreign[ghosts]
        self._groups.reduce(every)
        return every

    def _recovered(self, left: Array, b: Array) -> Array:
        """This rank's part of y from what is left of it and from reduced loads."""
        y = np.zeros(self._P.here)
        y[self.left] = left
        every = self._shared.with_ghosts(y)
        self._groups.recover(every, np.ascontiguousarray(b))
        of_others = self._shared.summed(every * self._foreign)
        return np.where(self._lent, of_others, self._shared.owned(every))


def _summed(own: PETSc.Mat, numbers: NDArray[np.int32], here: int, comm: PETSc.Comm) -> PETSc.Mat:
    """The sum over all ranks of matrices whose rows and columns have these global numbers."""
    places, size = PETSc.LGMap().create(numbers, comm=comm), (here, None)
    matrix = PETSc.Mat().createIS((size, size), lgmapr=places, lgmapc=places, comm=comm)
    matrix.setISLocalMat(own)
    matrix.assemble()
    places.destroy()
    return matrix
