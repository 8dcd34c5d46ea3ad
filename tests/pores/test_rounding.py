"""What rounding leaves of a disc in two narrow gaps at once: bars hold it, or the flow is refused."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.errors import SolveError
from fsi.pores.accuracy import solve_with_errors
from fsi.pores.resistance import resistance_with_error


def between_walls(gap: float, x: float, **more: object) -> Case:
    """A disc with the same gap to both walls of a channel."""
    body = {"name": "disc", "radius": 1.0, "position": [x, 1.0 + gap]} | more
    domain = {"lower": [0.0, 0.0], "upper": [6.0, 2.0 + 2.0 * gap], "periodic": ["x"]}
    data = {"name": "t", "model": "pores", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": [body]}
    return parse_case(data | {"pores": {"modes": 4}})


@pytest.mark.parametrize(("gap", "least", "most"), [(1e-5, 1e-4, 1e-3), (3e-6, 5e-4, 1e-2)])
def test_slides_by_two_narrow_gaps_are_off_by_less_than_their_bar(
    gap: float, least: float, most: float
) -> None:
    """Where the disc stands along the channel makes no difference but for rounding; squeezes keep digits."""
    found = [resistance_with_error(between_walls(gap, x)) for x in (0.4234567, 1.077)]
    R = np.array([one.resistance.R for one in found])
    bars = np.array([one.errors.R for one in found])
    assert np.all(np.abs(R[1] - R[0]) <= bars.min(axis=0))
    assert least < bars[0, 0, 0] / R[0, 0, 0] < most
    assert bars[0, 1, 1] < 1e-5 * R[0, 1, 1]


def test_what_is_worse_is_refused() -> None:
    with pytest.raises(SolveError, match=r"reciprocity|not positive"):
        resistance_with_error(between_walls(3e-8, 0.3))
    with pytest.raises(SolveError, match=r"is violated by .*; widen the narrowest gaps"):
        solve_with_errors(between_walls(1e-7, 0.3, force=[1.0, 0.0]))
