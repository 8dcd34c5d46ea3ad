"""CVXOPT's sparse matrix of columns that are in order already, written where it has them.

In Python CVXOPT makes sparse matrices of triplets alone, which it searches and sorts: that takes longer than
to add the matrix up, and several times its memory. Its interface for C, `cvxopt.h`, makes one with room:

    typedef struct { void *values; int_t *colptr, *rowind; int_t nrows, ncols; int id; } ccs;
    typedef struct { PyObject_HEAD ccs *obj; } spmatrix;
"""

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from fsi.arrays import Array, Indices
from fsi.errors import SolveError

# Writes the rows of all entries, ascending in each column, and their values.
type Writer = Callable[[Indices, Array], None]

_INT = ctypes.c_ssize_t  # int_t
_DOUBLE = 1  # the id of real matrices
_API, _NEW = b"base_API", 4  # the table of functions, and the place of SpMatrix_New


class _Columns(ctypes.Structure):
    """ccs."""

    _fields_ = (
        ("values", ctypes.POINTER(ctypes.c_double)),
        ("colptr", ctypes.POINTER(_INT)),
        ("rowind", ctypes.POINTER(_INT)),
        ("nrows", _INT),
        ("ncols", _INT),
        ("id", ctypes.c_int),
    )


def sparse_matrix(first: Indices, write: Writer) -> Any:
    """CVXOPT's square matrix whose columns begin there among the entries, and their end, (n + 1,).

    Raises SolveError: CVXOPT has matrices of another kind.
    """
    _require_known()
    return _written(first, write)


@cache
def _require_known() -> None:
    """Raise SolveError unless a small matrix that is written is that which CVXOPT makes of triplets."""
    from cvxopt import spmatrix

    def write(row: Indices, value: Array) -> None:
        row[:], value[:] = (0, 2, 1), (4.0, 5.0, 6.0)

    known = spmatrix([4.0, 5.0, 6.0], [0, 2, 1], [0, 0, 2], (3, 3)).CCS
    found = _written(np.array([0, 2, 2, 3]), write).CCS
    _require(all(list(one) == list(other) for one, other in zip(found, known, strict=True)))


def _written(first: Indices, write: Writer) -> Any:
    from cvxopt import spmatrix

    n, entries = len(first) - 1, int(first[-1])
    made = _new()(n, n, entries, _DOUBLE)
    _require(type(made) is spmatrix and made.size == (n, n) and made.typecode == "d")
    _require(spmatrix.__basicsize__ == object.__basicsize__ + ctypes.sizeof(ctypes.c_void_p))
    columns = ctypes.POINTER(_Columns).from_address(id(made) + object.__basicsize__).contents
    _require((columns.nrows, columns.ncols, columns.id) == (n, n, _DOUBLE))
    np.ctypeslib.as_array(columns.colptr, (n + 1,))[:] = first
    write(*(np.ctypeslib.as_array(begin, (entries,)) for begin in (columns.rowind, columns.values)))
    _require(len(made) == entries)
    return made


@cache
def _new() -> Callable[[int, int, int, int], Any]:
    """SpMatrix_New(nrows, ncols, entries, id): without entries yet, but with room for them."""
    from cvxopt import base

    pointer = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)
    table = pointer(("PyCapsule_GetPointer", ctypes.pythonapi))(base._C_API, _API)
    address = ctypes.cast(table, ctypes.POINTER(ctypes.c_void_p))[_NEW]
    return ctypes.PYFUNCTYPE(ctypes.py_object, _INT, _INT, _INT, ctypes.c_int)(address)


def _require(holds: bool) -> None:
    if not holds:
        raise SolveError("pores: CVXOPT's sparse matrices are not those of its version 1.3.3: install that")
