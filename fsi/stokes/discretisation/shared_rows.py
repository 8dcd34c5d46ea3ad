"""What ranks tell each other of rows that several of them meet.

The rows of x = (u, p) that a rank's cells meet have local numbers: u at all velocity nodes of this rank, its
own first, ghosts then, d rows each; then p at all pressure nodes, again its own first. On one rank they are
the numbers of the rows themselves.
"""

from itertools import pairwise

import numpy as np
from dolfinx.common import IndexMap
from mpi4py import MPI
from numpy.typing import NDArray

from fsi.arrays import Indices
from fsi.stokes.discretisation.forms import Forms


class Shared:
    """For arrays of any type whose first axis are rows with local numbers.

    Attributes:
        size: how many local numbers there are; alone all are a rank's own.
        own: those of the rows that this rank owns, in their order.
        ghosts: all others.
        lent: which of its own rows others meet.
    """

    def __init__(self, size: int, own: Indices, ghosts: Indices, owned: Indices, owner: Indices) -> None:
        """Collective. owned: which of its rows each ghost is for its owner."""
        self._comm: MPI.Intracomm = MPI.COMM_WORLD
        ranks = range(self._comm.size)
        self.size, self.own, self.ghosts = size, own, ghosts
        self._stretches = _stretches(own)
        self._ghosts = [ghosts[owner == rank] for rank in ranks]
        self._lent = self._comm.alltoall([owned[owner == rank] for rank in ranks])
        self.lent: Indices = np.unique(np.concatenate(self._lent))

    def with_ghosts[T: np.generic](self, values: NDArray[T]) -> NDArray[T]:
        """Values of this rank's rows in local numbers, those of ghosts from their owners; collective."""
        if self._comm.size == 1:
            return values.copy()
        every = np.empty((self.size, *values.shape[1:]), dtype=values.dtype)
        for local, row in self._stretches:
            every[local] = values[row]
        for local, part in zip(
            self._ghosts, self._comm.alltoall([values[k] for k in self._lent]), strict=True
        ):
            every[local] = part
        return every

    def summed[T: np.generic](self, every: NDArray[T]) -> NDArray[T]:
        """The sums over all ranks of values in local numbers, on this rank's rows; collective."""
        if self._comm.size == 1:
            return every.copy()
        values = self.owned(every)
        for row, part in zip(self._lent, self._comm.alltoall([every[k] for k in self._ghosts]), strict=True):
            np.add.at(values, row, part)
        return values

    def owned[T: np.generic](self, every: NDArray[T]) -> NDArray[T]:
        """Those of values in local numbers that are of this rank's rows, copied."""
        values = np.empty((len(self.own), *every.shape[1:]), dtype=every.dtype)
        for local, row in self._stretches:
            values[row] = every[local]
        return values


def _stretches(numbers: Indices) -> list[tuple[slice, slice]]:
    """Stretches of numbers that follow each other, and where they stand: slices are faster than numbers."""
    bounds = [0, *(np.flatnonzero(np.diff(numbers) != 1) + 1), len(numbers)]
    return [
        (slice(numbers[begin], numbers[end - 1] + 1), slice(begin, end))
        for begin, end in pairwise(bounds)
        if end > begin
    ]


class SharedRows(Shared):
    """The rows of x that this rank's cells meet.

    Attributes:
        pressures: the local number of the first pressure.
    """

    def __init__(self, forms: Forms) -> None:
        """Collective."""
        V, Q, d = forms.V.dofmap.index_map, forms.Q.dofmap.index_map, forms.V.dofmap.index_map_bs
        velocities, pressures = V.size_local * d, V.size_local + V.num_ghosts
        self.pressures = pressures * d
        size = self.pressures + Q.size_local + Q.num_ghosts
        own = np.concatenate([np.arange(velocities), self.pressures + np.arange(Q.size_local)])
        starts = np.array(MPI.COMM_WORLD.allgather((V.local_range[0], Q.local_range[0], V.size_local * d)))
        of_both = [
            (velocities + np.arange(V.num_ghosts * d), _rows(V, V, starts, d), np.repeat(V.owners, d)),
            (self.pressures + Q.size_local + np.arange(Q.num_ghosts), _rows(Q, V, starts, d), Q.owners),
        ]
        ghosts, owned, owner = (np.concatenate([part[k] for part in of_both]) for k in range(3))
        super().__init__(size, own, ghosts, owned, owner)


def _rows(of: IndexMap, V: IndexMap, starts: Indices, d: int) -> Indices:
    """The rows of ghosts, counted from the first one of their owner."""
    if of is V:
        node = of.ghosts - starts[of.owners, 0]
        return np.asarray((d * node[:, None] + np.arange(d)).ravel())
    rows: Indices = starts[of.owners, 2] + of.ghosts - starts[of.owners, 1]
    return rows


def shared_columns(columns: Indices, here: int) -> tuple[Indices, Shared]:
    """The global numbers, ascending, of a rank's own columns and of others that it meets; collective.

    here: how many of them the rank owns.
    """
    comm = MPI.COMM_WORLD
    starts = np.concatenate([[0], np.cumsum(comm.allgather(here))])
    met = np.zeros(starts[-1], dtype=bool)
    met[columns] = met[starts[comm.rank] : starts[comm.rank + 1]] = True
    numbers = np.flatnonzero(met)
    owner = np.searchsorted(starts, numbers, side="right") - 1
    own, ghosts = np.flatnonzero(owner == comm.rank), np.flatnonzero(owner != comm.rank)
    owned = numbers[ghosts] - starts[owner[ghosts]]
    return numbers, Shared(len(numbers), own, ghosts, owned, owner[ghosts])
