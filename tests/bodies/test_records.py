"""Rows of records of arrays and sparse matrices."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fsi.arrays import Array
from fsi.bodies.records import joined, those


@dataclass(frozen=True, slots=True)
class _Rows:
    """n rows."""

    G: sp.csr_matrix
    own: Array


def test_what_is_joined_can_be_taken_apart() -> None:
    one, other = (_Rows(sp.csr_matrix(k * np.eye(2)), np.full(2, k)) for k in (1.0, 2.0))
    both = joined([one, other])
    np.testing.assert_array_equal(both.own, [1.0, 1.0, 2.0, 2.0])
    np.testing.assert_array_equal(both.G.toarray(), [[1.0, 0.0], [0.0, 1.0], [2.0, 0.0], [0.0, 2.0]])
    again = those(both, np.array([False, False, True, True]))
    np.testing.assert_array_equal(again.own, other.own)
    np.testing.assert_array_equal(again.G.toarray(), other.G.toarray())
