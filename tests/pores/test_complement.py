"""The lower bound of the viscosity of a cell: below every other number, rising to it with modes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bench.pore_arrays import ONE, cell_of
from fsi.case.load import parse_case
from fsi.observables.bars import DrivenBodies
from fsi.pores.complement import least_viscosity
from fsi.pores.fineness import Fineness
from fsi.pores.instant import PoreInstant
from fsi.pores.model import driven
from fsi.pores.surfaces import surfaces_of
from fsi.pores.system import PoreSystem

SHEAR = np.array([[0.0, 1.0], [0.0, 0.0]])
BODIES = [
    {"name": "one", "radius": 1.0, "position": [1.6, 1.5]},
    {"name": "other", "radius": 0.7, "position": [3.3, 2.2]},
]
# Of the square array at c = 0.5 and 0.7 in shear along it: pores with 16 modes, from above.
SQUARE = {0.5: 2.2550192, 0.7: 4.5024895}


def in_cell(modes: int, flow: dict[str, float], **more: Any) -> PoreInstant:
    cell = {"shape": "cell", "vectors": [[5.0, 0.0], [1.0, 4.0]]} | flow
    data = {"name": "two", "model": "pores", "fluid": {"viscosity": 3.0}, "domain": cell, "bodies": BODIES}
    case = parse_case(data | more)
    q = case.configuration()
    return driven(DrivenBodies(case, q, 0.0, case.motion_at(q, 0.0)), Fineness.even(modes))


@pytest.mark.parametrize("c", SQUARE)
def test_the_bound_of_a_square_array_rises_to_its_viscosity(c: float) -> None:
    """At c = 0.7, with gaps of a ninth of the radius: 1.3e-2, 5e-3, 7e-5 below; at 0.5 nearer."""
    cell = cell_of("square", c, SHEAR)
    bounds = []
    for modes in (2, 4, 8):
        system = PoreSystem.make(surfaces_of(ONE, cell), modes, 1.0)
        bounds.append(least_viscosity(system, 0.5 * (SHEAR + SHEAR.T)))
    assert np.all(np.diff(bounds) > 0.0)
    off = 1.0 - np.array(bounds) / SQUARE[c]
    assert np.all(off > -1e-7)
    assert np.all(off < [2e-2, 8e-3, 2e-4])


@pytest.mark.parametrize("flow", [{"shear": 1.0}, {"shear": -2.0}, {"extension": 0.5}])
def test_the_viscosity_of_a_cell_lies_between_its_bounds(flow: dict[str, float]) -> None:
    """That with many modes, in a cell where shear makes normal stresses; a wrong M would be off by 1e-2."""
    exact = in_cell(12, flow).apparent_viscosity
    assert exact is not None
    for modes, width in ((0, 1e-2), (4, 1e-3)):
        found = in_cell(modes, flow)
        assert found.apparent_viscosity is not None
        assert found.lower_bound is not None
        assert exact * (1.0 - width) < found.lower_bound < exact * (1.0 + 1e-7)
        assert found.apparent_viscosity > exact


def test_only_cells_whose_bodies_bear_no_loads_have_it() -> None:
    channel = {"lower": [0.0, 0.0], "upper": [5.0, 4.5], "periodic": ["x"], "walls": {"top": [1.0, 0.0]}}
    assert in_cell(0, {}, domain=channel).lower_bound is None
    pulled = [BODIES[0] | {"force": [1.0, 0.0]}, BODIES[1]]
    assert in_cell(0, {"shear": 1.0}, bodies=pulled).lower_bound is None
    assert in_cell(0, {}).lower_bound is None
