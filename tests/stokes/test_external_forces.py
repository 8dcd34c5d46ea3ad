"""Forces between bodies reach the resolved flow, which balances them."""

import math
from typing import Any

import numpy as np
import pytest

from fsi.case.load import parse_case
from fsi.stokes.adapt import solve_with_errors
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution


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


def test_one_instant_has_the_forces_of_the_first_step_of_a_run() -> None:
    """`fsi solve` left them out: the disc fell with nothing but what its own `force` gives."""
    disc = {"name": "disc", "radius": 1.0, "position": [0.0, 2.0], "force": [1.0, 0.0]}
    weight = {"kind": "gravity", "acceleration": [0.0, -3.0], "density_difference": 2.0}
    domain = {"lower": [-5.0, 0.0], "upper": [5.0, 5.0]}
    data = {"name": "t", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": [disc], "forces": [weight]}
    found = solve_with_errors(parse_case(data)).solution
    np.testing.assert_allclose(found.F, [[1.0, -6.0 * math.pi, 0.0]], atol=1e-8)
    assert found.U[0, 1] < -0.1


REPULSION = {"kind": "repulsion", "law": "exponential", "strength": 5.0, "length": 0.3, "cutoff": 2.0}
SHEARED = {
    "lower": [0.0, 0.0], "upper": [5.0, 5.0], "periodic": ["x"],
    "walls": {"bottom": [-2.5, 0.0], "top": [2.5, 0.0]},
}  # fmt: skip


def sheared(domain: dict[str, Any], bodies: list[tuple[float, float, float]], *forces: Any) -> StokesSolution:
    listed = [{"name": f"d{k}", "radius": a, "position": [x, y]} for k, (x, y, a) in enumerate(bodies)]
    data = {
        "name": "t",
        "fluid": {"viscosity": 1.0},
        "domain": domain,
        "bodies": listed,
        "forces": list(forces),
    }
    case = parse_case(data)
    return StokesModel(case)(case.configuration(), 0.0)


def test_the_bulk_stress_has_what_forces_between_bodies_carry() -> None:
    """So that it is that of the walls: their stress is 1.942, of fluid and stresslets alone 1.831."""
    bodies = [(0.2, 1.0, 0.8), (4.2, 2.4, 0.8), (2.0, 3.0, 0.7)]
    found = sheared(SHEARED, bodies, REPULSION | {"walls": True})
    assert found.bulk is not None
    assert found.apparent_viscosity == pytest.approx(found.bulk.mean[0, 1], rel=1e-10)
    assert abs(found.bulk.forces[0, 1]) > 0.1


def test_forces_that_balance_on_every_body_still_stress_a_cell() -> None:
    """In a square array each disc is pushed alike from all sides: the flow is that without forces.

    Sigma changes by - sum f d n (x) n / d^2 = - f / d I.
    """
    cell = {"shape": "cell", "vectors": [[2.5, 0.0], [0.0, 2.5]], "shear": 1.0}
    without, found = (
        sheared(cell, [(0.3, 0.2, 1.0)], *forces) for forces in ((), (REPULSION | {"cutoff": 1.0},))
    )
    assert found.bulk is not None
    assert without.bulk is not None
    f = 5.0 * math.exp(-0.5 / 0.3)
    np.testing.assert_allclose(found.bulk.mean - without.bulk.mean, -f / 2.5 * np.eye(2), atol=1e-9)
    assert found.apparent_viscosity == pytest.approx(without.apparent_viscosity, rel=1e-9)


def test_forces_that_cancel_on_a_body_do_not_count_as_none() -> None:
    """A disc between its images at a gap of 0.5 along x: pushed from both sides alike, it stresses the cell.

    The stress that the forces carry is no part of what is dissipated, so that the checks for bodies without
    forces do not apply: they would refuse the flow.
    """
    cell = {"shape": "cell", "vectors": [[2.5, 0.0], [0.0, 6.0]], "extension": 0.3}
    found = sheared(cell, [(0.0, 0.0, 1.0)], REPULSION)
    assert found.bulk is not None
    push = 5.0 * math.exp(-0.5 / 0.3)
    np.testing.assert_allclose(found.bulk.forces, [[-2.5 * push / 15.0, 0.0], [0.0, 0.0]], rtol=1e-12)
    np.testing.assert_allclose(found.F, 0.0, atol=1e-8)
    assert "stress" not in found.checks
