"""Compiled loops over rows with as many entries each; see `fsi.bodies.rows`."""

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.machine.compiled import compiled

type Columns = tuple[NDArray[np.int32], ...]
type Entries = tuple[Array, ...]


class Products:
    """`z -> J J^T z`: the k-th entries of all rows stand together, 0 where a row has fewer than others."""

    def __init__(self, J: sp.csr_matrix) -> None:
        """Of rows J, (R, M)."""
        counts = np.diff(J.indptr)
        places = J.indptr[:-1] + np.arange(counts.max())[:, None]  # (entries of a row, R)
        there = np.arange(counts.max())[:, None] < counts
        places[~there] = 0
        self._columns: Columns = tuple(J.indices[places].astype(np.int32))
        self._entries: Entries = tuple(np.where(there, J.data[places], 0.0))
        self._transposed = np.empty(J.shape[1])

    def __call__(self, z: Array) -> Array:
        """The product, (R,)."""
        product = np.empty(len(z))
        _gram(self._columns, self._entries, z, self._transposed, product)
        return product


@compiled
def _gram(columns: Columns, entries: Entries, z: Array, transposed: Array, product: Array) -> None:
    """`J^T z`, (M,), then J times it, (R,); how many arrays of entries there are is known to the compiler."""
    transposed[:] = 0.0
    for r in range(len(z)):
        for k in range(len(entries)):
            transposed[columns[k][r]] += entries[k][r] * z[r]
    for r in range(len(z)):
        total = 0.0
        for k in range(len(entries)):
            total += entries[k][r] * transposed[columns[k][r]]
        product[r] = total
