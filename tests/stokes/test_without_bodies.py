"""Flows without bodies: the tolerance is that of their dissipation, corners of sliding lids."""

from __future__ import annotations

from typing import Any

import pytest

from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.stokes.adapt import Solved, solve_with_errors
from tests.stokes.test_error import without_tolerance

SQUARE = {"lower": [0.0, 0.0], "upper": [1.0, 1.0]}


def wavy(walls: dict[str, Any]) -> Case:
    """A channel without bodies, with few cells and a tolerance."""
    wave = {"kind": "wave", "height": 0.2, "length": 2.0, "number": 1, "start": -1.0}
    domain = {"lower": [-2.0, 0.0], "upper": [2.0, 2.0], "walls": walls, "profiles": {"bottom": wave}}
    sizes = {"cells_per_circle": 12, "growth": 0.8, "degree": 3, "tolerance": 2e-4}
    fluid = {"viscosity": 1.0}
    return parse_case({"name": "wavy", "fluid": fluid, "domain": domain, "discretisation": sizes})


def test_without_bodies_the_dissipation_has_the_tolerance() -> None:
    """Its bar is 5.9e-4 of it with the sizes of the case, whose cells are small at both ends of the wave."""
    case = wavy({"left": {"pressure": 1.0}, "right": "open"})
    rough, solved = solve_with_errors(without_tolerance(case)), solve_with_errors(case)
    assert rough.errors.dissipation > 5e-4 * rough.solution.dissipation
    assert solved.error == solved.errors.dissipation / solved.solution.dissipation <= 2e-4


@pytest.mark.parametrize(
    "walls",
    [
        {"left": {"pressure": 1.0}, "right": {"pressure": 1.0}},
        {"left": [1.0, 0.0], "right": [1.0, 0.0], "top": [1.0, 0.0], "bottom": [1.0, 0.0]},
    ],
)
def test_a_fluid_that_nothing_shears_has_any_tolerance(walls: dict[str, Any]) -> None:
    """Its dissipation is what rounding leaves, 1e-27: meshes were refined after it without end."""
    sizes = {"tolerance": 1e-4, "cells_per_circle": 12, "growth": 0.8}
    case = {"name": "unmoved", "fluid": {"viscosity": 1.0}, "domain": SQUARE | {"walls": walls}}
    solved = solve_with_errors(parse_case(case | {"discretisation": sizes}))
    assert solved.solution.dissipation < 1e-24
    assert (solved.error, solved.case.discretisation.growth) == (0.0, 0.8)


def test_a_lid_along_which_fluid_slides_ends_in_corners() -> None:
    """u ~ r ln r there: without finer cells errors were 2e-3, at any growth, and 1.1 to 1.6 of their bars."""

    def lid(degree: int) -> Solved:
        walls = {"top": {"velocity": [1.0, 0.0], "slip_length": 0.2}}
        case = {"name": "lid", "fluid": {"viscosity": 1.0}, "domain": SQUARE | {"walls": walls}}
        return solve_with_errors(parse_case(case | {"discretisation": {"degree": degree}}))

    exact = lid(6).solution.dissipation
    for degree, most in ((3, 4e-5), (4, 2e-6)):
        found = lid(degree)
        assert abs(found.solution.dissipation - exact) < found.errors.dissipation < most


def test_a_tolerance_of_nothing_is_refused() -> None:
    with pytest.raises(InputError, match=r"discretisation\.tolerance = 0\.0002: .* infinite here"):
        solve_with_errors(wavy({"top": [1.0, 0.0]}))
