"""The lower bound of the viscosity of cells and channels: below all other numbers, rising with modes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bench.pore_arrays import ONE, cell_of
from fsi.case.load import parse_case
from fsi.observables.bars import DrivenBodies
from fsi.pores.complement import LeastStresses
from fsi.pores.fineness import Fineness
from fsi.pores.fluid_discs import pores_without_wide
from fsi.pores.instant import PoreInstant
from fsi.pores.model import driven
from fsi.pores.surfaces import BoundingSurfaces, surfaces_of
from tests.pore_surfaces import couette

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


def bound(surfaces: BoundingSurfaces, modes: int) -> float:
    """In shear, with so many modes for each neck."""
    pores = pores_without_wide(surfaces)
    return LeastStresses.of(pores, np.full(len(pores.necks), modes)).viscosity(0.5 * (SHEAR + SHEAR.T))


@pytest.mark.parametrize("c", SQUARE)
def test_the_bound_of_a_square_array_rises_to_its_viscosity(c: float) -> None:
    """At c = 0.7, with gaps of a ninth of the radius: 5e-5, 5e-5, 8e-7 below; at 0.5 nearer. Were linear
    functions not exact around discs, they would be 5e-3, 2e-3 and 3e-6 below."""
    cell = cell_of("square", c, SHEAR)
    bounds = [bound(surfaces_of(ONE, cell), modes) for modes in (2, 4, 8)]
    assert np.all(np.diff(bounds) > 0.0)
    off = 1.0 - np.array(bounds) / SQUARE[c]
    assert np.all(off > -1e-7)
    assert np.all(off < [1e-4, 1e-4, 1.5e-6])


@pytest.mark.parametrize("flow", [{"shear": 1.0}, {"shear": -2.0}, {"extension": 0.5}])
def test_the_viscosity_of_a_cell_lies_between_its_bounds(flow: dict[str, float]) -> None:
    """That with many modes, in a cell where shear makes normal stresses; a wrong M would be off by 1e-2."""
    exact = in_cell(12, flow).apparent_viscosity
    assert exact is not None
    for modes, width in ((0, 4e-4), (4, 1e-5)):
        found = in_cell(modes, flow)
        assert found.apparent_viscosity is not None
        assert found.lower_bound is not None
        assert exact * (1.0 - width) < found.lower_bound < exact * (1.0 + 1e-7)
        assert found.apparent_viscosity > exact


def test_the_bound_of_ten_discs_in_a_channel_rises_to_the_exact_viscosity() -> None:
    """8.298079598524666 by spectral boundary integrals, gaps from 0.02; 2e-4, 2e-6 and 1e-7 below it."""
    surfaces, _, exact = couette()
    bounds = [bound(surfaces, modes) for modes in (4, 8, 12)]
    off = 1.0 - np.array(bounds) / exact
    assert np.all(off > 0.0)
    assert np.all(off < [4e-4, 5e-6, 5e-7])


def between_walls(gap: float) -> PoreInstant:
    """A disc with the same gap to both walls of a channel, of which one slides."""
    channel = {"lower": [0.0, 0.0], "upper": [3.0, 2.0 + 2.0 * gap], "periodic": ["x"]}
    domain = channel | {"walls": {"top": [1.0, 0.0]}}
    body = {"name": "one", "radius": 1.0, "position": [1.0, 1.0 + gap]}
    return in_cell(8, {}, domain=domain, bodies=[body])


@pytest.mark.parametrize(("gap", "width"), [(1e-1, 1e-5), (1e-2, 1e-5), (1.1e-3, 2e-2)])
def test_bounds_enclose_the_viscosity_down_to_narrow_gaps(gap: float, width: float) -> None:
    """Of a disc between two walls as near to it: 8e-7, 1e-6 and 6e-3 apart, as digits cancel."""
    found = between_walls(gap)
    assert found.apparent_viscosity is not None
    assert found.lower_bound is not None
    assert (1.0 - width) * found.apparent_viscosity < found.lower_bound < found.apparent_viscosity


def test_where_rounding_would_tell_there_is_no_lower_bound() -> None:
    """Below 5e-4 for gap / 2 a; of a gap of 2e-4 it would be 0.35 below, of three discs with gaps of 1e-6
    1.67 where 1.54 is true."""
    assert between_walls(0.9e-3).lower_bound is None


def test_only_flows_of_bodies_that_bear_no_loads_have_it() -> None:
    channel: dict[str, Any] = {"lower": [0.0, 0.0], "upper": [5.0, 4.5], "periodic": ["x"]}
    sheared = channel | {"walls": {"top": [1.0, 0.0]}}
    pulled = [BODIES[0] | {"force": [1.0, 0.0]}, BODIES[1]]
    assert in_cell(0, {"shear": 1.0}, bodies=pulled).lower_bound is None
    assert in_cell(0, {}, domain=sheared, bodies=pulled).lower_bound is None
    assert in_cell(0, {}, domain=sheared | {"pressure_gradient": 1.0}).lower_bound is None
    assert in_cell(0, {}).lower_bound is None


@pytest.mark.parametrize("modes", [1, 2, 4])
def test_the_viscosity_of_a_dilute_cell_lies_between_its_bounds(modes: int) -> None:
    """1 + 2 phi (Einstein's coefficient in the plane), phi = 1e-4, but for some phi^2.

    Near a disc so small psi varies in a small part of its pores: with the points of even ones two modes gave
    1.0001889 as an upper bound, 1.0002002 as a lower one, and one mode fell below 1 / (1 - phi).
    """
    side, phi = np.sqrt(np.pi / 1e-4), 1e-4
    domain = {"shape": "cell", "vectors": [[side, 0.0], [0.0, side]], "shear": 1.0}
    found = in_cell(modes, {}, domain=domain, bodies=[BODIES[0]], fluid={"viscosity": 1.0})
    assert found.lower_bound is not None
    assert found.apparent_viscosity is not None
    exact, room = 1.0 + 2.0 * phi, 10.0 * phi**2
    assert exact - 0.01 * phi < found.lower_bound < exact + room
    assert exact - room < found.apparent_viscosity < exact + 0.2 * phi
