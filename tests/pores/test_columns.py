"""Matrices that are written where CVXOPT has them, against those that it makes of triplets."""

import ctypes
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from cvxopt import matrix, spmatrix
from hypothesis import given
from hypothesis import strategies as st

from fsi.arrays import Array, Indices
from fsi.errors import SolveError
from fsi.pores import columns
from fsi.pores.columns import sparse_matrix


def written(A: sp.csc_matrix) -> Any:
    def write(row: Indices, value: Array) -> None:
        row[:], value[:] = A.indices, A.data

    return sparse_matrix(A.indptr, write)


@given(n=st.integers(1, 30), density=st.floats(0.0, 1.0), seed=st.integers(0, 99))
def test_a_matrix_that_is_written_is_that_of_its_triplets(n: int, density: float, seed: int) -> None:
    """Where columns begin, rows and values; some columns, or all, are empty."""
    A = sp.csc_matrix(sp.random_array((n, n), density=density, rng=np.random.default_rng(seed)))
    A.sort_indices()
    row, column = A.nonzero()
    known = spmatrix(
        matrix(A[row, column].A1 if A.nnz else 0.0, (A.nnz, 1)), row.tolist(), column.tolist(), (n, n)
    )
    found = written(A)
    assert found.size == (n, n)
    for one, other in zip(found.CCS, known.CCS, strict=True):
        assert list(one) == list(other)


@pytest.mark.parametrize(
    "other",
    [
        spmatrix([1.0], [0], [0], (3, 3), "z"),
        spmatrix([1.0], [0], [0], (3, 2)),
        matrix(0.0, (3, 3)),
    ],
    ids=["complex", "of another size", "dense"],
)
def test_what_is_no_such_matrix_is_not_written_to(other: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(columns, "_new", lambda: lambda *_: other)
    before = list(other)
    with pytest.raises(SolveError, match="CVXOPT's sparse matrices"):
        written(sp.csc_matrix(np.eye(3)))
    assert list(other) == before


def test_sizes_that_stand_elsewhere_in_it_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before any of its pointers is followed: here they are taken for sizes, and sizes for pointers."""

    class Moved(ctypes.Structure):
        _fields_ = (
            columns._Columns._fields_[3:5] + columns._Columns._fields_[:3] + columns._Columns._fields_[5:]
        )

    monkeypatch.setattr(columns, "_Columns", Moved)
    with pytest.raises(SolveError, match="CVXOPT's sparse matrices"):
        written(sp.csc_matrix(np.eye(3)))
