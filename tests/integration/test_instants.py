"""What models tell of one instant: all of them have all of it, so that a misspelt name is an error."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fsi.integration.state import velocities
from fsi.observables.bars import Compared, DrivenBodies, step_errors
from fsi.observables.quantities import stress_driven
from tests.exact_model import ExactInstant, settling_case

U = np.array([[1.0, 0.0, 0.0]])


def test_what_an_instant_lacks_is_an_error_and_not_something_that_it_does_not_know() -> None:
    bare: Any = SimpleNamespace(U=U, F=U, wall_speeds={}, shear_rate=None)
    np.testing.assert_array_equal(velocities(bare), U)
    with pytest.raises(AttributeError, match="'dp_dx'"):
        stress_driven(bare)
    del bare.shear_rate
    with pytest.raises(AttributeError, match="'shear_rate'"):
        velocities(bare)


def test_bars_are_of_flows_whose_dissipation_is_known() -> None:
    """It was not a number, and so was its bar."""
    case = settling_case(1.0)
    bare: Any = SimpleNamespace(U=U, F=U)
    bodies = DrivenBodies(case, case.configuration(), 0.0, case.motion(0.0))
    with pytest.raises(AttributeError, match="'dissipation'"):
        step_errors(bodies, bare, Compared(ExactInstant(U, U), 1.0))
