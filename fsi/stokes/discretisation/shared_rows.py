"""The rows of x = (u, p) that a rank owns, and those of other ranks that its cells meet.

Local numbers: u at all velocity nodes of this rank, its own first, ghosts then, d rows each; then p at all
pressure nodes, again its own first. On one rank they are the numbers of the rows themselves.
"""

import numpy as np
from dolfinx.common import IndexMap
from mpi4py import MPI
from numpy.typing import NDArray

from fsi.stokes.discretisation.forms import Forms

Index = NDArray[np.int64]


class SharedRows:
    """What ranks tell each other of shared rows, for arrays of any type whose first axis are rows.

    Attributes:
        size: how many local numbers there are.
        pressures: the first of a pressure.
        own: those of the rows that this rank owns, in their order.
        ghosts: all others.
    """

    def __init__(self, forms: Forms) -> None:
        """Collective."""
        V, Q, d = forms.V.dofmap.index_map, forms.Q.dofmap.index_map, forms.V.dofmap.index_map_bs
        self._comm: MPI.Intracomm = MPI.COMM_WORLD
        velocities, pressures = V.size_local * d, V.size_local + V.num_ghosts
        self.pressures = pressures * d  # the local number of the first one
        self.size = self.pressures + Q.size_local + Q.num_ghosts
        self.own = np.concatenate([np.arange(velocities), self.pressures + np.arange(Q.size_local)])
        ghosts = [
            (velocities + np.arange(V.num_ghosts * d), self._rows(V, V, Q, d), np.repeat(V.owners, d)),
            (self.pressures + Q.size_local + np.arange(Q.num_ghosts), self._rows(Q, V, Q, d), Q.owners),
        ]
        local, row, owner = (np.concatenate([part[k] for part in ghosts]) for k in range(3))
        self.ghosts = local
        self._ghosts = [local[owner == rank] for rank in range(self._comm.size)]
        self._lent = self._comm.alltoall([row[owner == rank] for rank in range(self._comm.size)])

    def _rows(self, of: IndexMap, V: IndexMap, Q: IndexMap, d: int) -> Index:
        """The rows of ghosts, counted from the first one of their owner."""
        starts = np.array(self._comm.allgather((V.local_range[0], Q.local_range[0], V.size_local * d)))
        if of is V:
            node = of.ghosts - starts[of.owners, 0]
            return np.asarray((d * node[:, None] + np.arange(d)).ravel())
        rows: Index = starts[of.owners, 2] + of.ghosts - starts[of.owners, 1]
        return rows

    def with_ghosts[T: np.generic](self, values: NDArray[T]) -> NDArray[T]:
        """Values of this rank's rows in local numbers, those of ghosts from their owners; collective."""
        every = np.empty((self.size, *values.shape[1:]), dtype=values.dtype)
        every[self.own] = values
        for local, part in zip(
            self._ghosts, self._comm.alltoall([values[k] for k in self._lent]), strict=True
        ):
            every[local] = part
        return every

    def summed[T: np.generic](self, every: NDArray[T]) -> NDArray[T]:
        """The sums over all ranks of values in local numbers, on this rank's rows; collective."""
        values = every[self.own]
        for row, part in zip(self._lent, self._comm.alltoall([every[k] for k in self._ghosts]), strict=True):
            np.add.at(values, row, part)
        return np.asarray(values)
