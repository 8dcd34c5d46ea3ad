"""Whether a mesh that was moved along with bodies gives what a new one does."""

from __future__ import annotations

import numpy as np

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.stokes.model import StokesModel


def gives_what_a_new_one_does(case: Case, way: Array, changes: float, tolerance: float) -> None:
    """The loads after displacements `way` (N, M), in parts of the largest.

    They agree to the tolerance, the errors of both meshes; the way changes them by `changes` or more.
    """
    moving = parse_case(case.as_data() | {"time": {"end": 1.0, "remesh": "when-needed"}})
    q, model = moving.configuration(), StokesModel(moving)
    first, near = model(q, 0.0), q.moved(way)
    moved, new = model(near, 0.1), StokesModel(case)(near, 0.1)
    assert moved.dofs == first.dofs
    assert np.abs(moved.F - first.F).max() > changes * np.abs(first.F).max()
    np.testing.assert_allclose(moved.F, new.F, atol=tolerance * np.abs(new.F).max())
