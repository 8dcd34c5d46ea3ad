"""Forces between bodies reach the resolved flow, which balances them."""

import math

import numpy as np

from fsi.case import parse_case
from fsi.stokes.model import StokesModel


def test_the_flow_balances_the_forces_at_the_place_that_it_is_asked_for() -> None:
    """F of the solution is the external load, at q and not at the case's start: f = 3 exp(-d/l) along x."""
    discs = [{"name": n, "radius": 1.0, "position": [x, 0.0]} for n, x in (("a", -1.5), ("b", 1.5))]
    force = {"kind": "repulsion", "law": "exponential", "strength": 3.0, "length": 0.5, "cutoff": 5.0}
    domain = {"lower": [-6.0, -5.0], "upper": [6.0, 5.0]}
    data = {"name": "t", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": discs, "forces": [force]}
    case = parse_case(data)
    q = case.configuration().moved(np.array([[0.25, 0.0, 0.0], [-0.25, 0.0, 0.0]]))
    solution = StokesModel(case)(q, 0.0)
    f = 3.0 * math.exp(-0.5 / 0.5)
    np.testing.assert_allclose(solution.F, [[-f, 0.0, 0.0], [f, 0.0, 0.0]], atol=1e-8)
    assert solution.U[0, 0] < 0.0 < solution.U[1, 0]
