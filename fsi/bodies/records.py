"""Records whose fields are arrays, or sparse matrices, with one row for each of the same things."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


def joined[Record: DataclassInstance](parts: Sequence[Record]) -> Record:
    """The rows of all parts, one after the other, of at least one."""
    return type(parts[0])(
        *(_stacked([getattr(part, field.name) for part in parts]) for field in fields(parts[0]))
    )


def those[Record: DataclassInstance](record: Record, which: NDArray[np.bool_]) -> Record:
    """The rows that are marked, which (n,)."""
    return type(record)(*(getattr(record, field.name)[which] for field in fields(record)))


def _stacked(values: list[Any]) -> Any:
    return sp.vstack(values, "csr") if sp.issparse(values[0]) else np.concatenate(values)
