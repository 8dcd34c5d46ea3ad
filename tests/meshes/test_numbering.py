"""Numbers of the sides and nodes of cells."""

import numpy as np
import pytest

from fsi.meshes.planar.triangulate import ascending, distinct


@pytest.mark.parametrize("width", [1, 2, 3, 4])
def test_rows_come_in_order(width: int) -> None:
    rows = np.random.default_rng(width).integers(0, 5, (200, width))
    np.testing.assert_array_equal(np.column_stack(ascending(rows.T)), np.sort(rows, axis=1))


def test_distinct_keys_are_those_of_numpy() -> None:
    """The first of equal ones too: nodes take the places that they have in the first of their cells."""
    keys = np.random.default_rng(0).integers(0, 700, 5000)
    first, number = distinct(keys)
    _, of_numpy, number_of_numpy = np.unique(keys, return_index=True, return_inverse=True)
    np.testing.assert_array_equal(first, of_numpy)
    np.testing.assert_array_equal(number, number_of_numpy)
