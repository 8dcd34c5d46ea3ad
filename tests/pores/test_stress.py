"""Stresslets, mean stress and N_1 of pores: those of the resolved flow, and three ways to one viscosity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.models import make_model
from fsi.observables.bulk_stress import BulkStress
from fsi.pores.accuracy import SolvedPores, solve_with_errors
from fsi.pores.instant import PoreInstant
from fsi.report.pores import solution_json
from fsi.stokes.solution import StokesSolution

BODIES: list[dict[str, Any]] = [
    {"name": "one", "radius": 1.0, "position": [1.6, 1.5]},
    {"name": "other", "radius": 0.7, "position": [3.9, 2.9]},
]
CHANNEL = {
    "lower": [0.0, 0.0],
    "upper": [5.0, 4.0],
    "periodic": ["x"],
    "walls": {"top": [3.5, 0.0], "bottom": [-0.5, 0.0]},
}
CELL = {"shape": "cell", "vectors": [[5.0, 0.0], [1.0, 4.0]], "shear": 1.0}
FALLING = [{"kind": "gravity", "acceleration": [0.4, -0.7], "density_difference": 1.0}]


def case_of(**sections: Any) -> Case:
    data = {"name": "two", "model": "pores", "fluid": {"viscosity": 2.0}, "bodies": BODIES}
    return parse_case(data | {"pores": {"modes": 6}} | sections)


def resolved_stress(case: Case) -> BulkStress:
    """Elements of degree 4: their errors are below 2e-5 here."""
    data = case.as_data() | {"model": "resolved", "discretisation": {"degree": 4}}
    solved = make_model(parse_case(data))(case.configuration(), 0.0)
    assert isinstance(solved, StokesSolution)
    bulk = solved.bulk
    assert bulk is not None
    return bulk


def instant_of(case: Case) -> PoreInstant:
    instant = make_model(case)(case.configuration(), 0.0)
    assert isinstance(instant, PoreInstant)
    return instant


def deviator(T: Array) -> Array:
    """T less its trace, (..., 2, 2)."""
    less: Array = T - 0.5 * np.trace(T, axis1=-2, axis2=-1)[..., None, None] * np.eye(2)
    return less


def stress_of(solved: SolvedPores) -> BulkStress:
    assert solved.solution.bulk is not None
    return solved.solution.bulk


@pytest.mark.parametrize(
    "sections",
    [
        {"domain": CHANNEL},
        pytest.param({"domain": CHANNEL, "forces": FALLING}, marks=pytest.mark.slow),
        {"domain": CELL, "forces": FALLING},
    ],
    ids=["channel", "loads in a channel", "loads in a cell"],
)
def test_stresslets_and_mean_stress_are_those_of_the_resolved_flow(sections: dict[str, Any]) -> None:
    """Within the bars, and these are below a thousandth of the largest."""
    case = case_of(**sections)
    solved, bulk = solve_with_errors(case), resolved_stress(case)
    ours, bars = stress_of(solved), solved.errors.stress
    assert bars is not None
    S, largest = deviator(bulk.stresslets), float(np.abs(bulk.stresslets).max())
    assert np.all(np.abs(ours.stresslets - S) <= bars.stresslets + 2e-5)
    assert bars.stresslets.max() < 1e-3 * largest
    assert np.all(np.abs(ours.mean - deviator(bulk.mean)) <= bars.mean + 2e-5)
    N_1 = bulk.normal_stress_difference
    assert abs(N_1) > 0.01
    assert ours.normal_stress_difference == pytest.approx(N_1, abs=bars.normal_stress_difference + 2e-5)


def test_the_json_has_stresslets_less_their_traces() -> None:
    """S_xx + S_yy = 0 where the resolved sum is not; S_xx - S_yy is the resolved one, by both bars."""
    case = case_of(domain=CELL, forces=FALLING)
    solved, resolved = solve_with_errors(case), resolved_stress(case).stresslets
    bodies = solution_json(solved.case, solved.solution, solved.errors, None)["bodies"]
    S, bars = (np.array([body[key] for body in bodies]) for key in ("stresslet", "stresslet_error"))
    assert np.all(np.abs(np.trace(resolved, axis1=1, axis2=2)) > 0.1)
    np.testing.assert_array_equal(S[:, 0, 0] + S[:, 1, 1], 0.0)
    np.testing.assert_array_equal(S[:, 0, 1], S[:, 1, 0])
    missed = np.abs(S[:, 0, 0] - S[:, 1, 1] - (resolved[:, 0, 0] - resolved[:, 1, 1]))
    assert np.all(missed <= bars[:, 0, 0] + bars[:, 1, 1] + 4e-5)


@pytest.mark.parametrize("domain", [CHANNEL, CELL], ids=["channel", "cell"])
@pytest.mark.parametrize("modes", [0, 4])
def test_three_ways_lead_to_one_viscosity(domain: dict[str, Any], modes: int) -> None:
    """Forces on walls or power of the sides, dissipation, and the stresslets with the part of the fluid.

    That part is 2 mu E but for errors of quadrature: of fluid of viscosity 2 at rate 1 it is 2.
    """
    solved = solve_with_errors(case_of(domain=domain, pores={"modes": modes}))
    found, bulk = solved.solution, stress_of(solved)
    assert found.checks["stress"] < 1e-9
    assert found.apparent_viscosity == pytest.approx(bulk.mean[0, 1] / 2.0, rel=1e-9)
    assert bulk.fluid == pytest.approx(np.array([[0.0, 2.0], [2.0, 0.0]]), abs=2e-2)


@pytest.mark.parametrize("domain", [CHANNEL, CELL], ids=["channel", "cell"])
def test_mean_stress_and_balance_of_forces_do_not_know_where_y_is_0(domain: dict[str, Any]) -> None:
    """2^20 from there, where places keep 1e-10, to 2e-11 and 2e-15.

    Moments about y = 0 would lose 1.2e-3 of the stress in the channel, 4e-6 in the cell; 2e-10 of the forces.
    """

    def at(y: float) -> PoreInstant:
        corners = {key: [domain[key][0], domain[key][1] + y] for key in ("lower", "upper") if key in domain}
        bodies = [body | {"position": np.add(body["position"], [0.0, y]).tolist()} for body in BODIES]
        case = case_of(domain=domain | corners, bodies=bodies, forces=FALLING, pores={"modes": 1})
        return instant_of(case)

    near, far = at(0.0), at(2.0**20)
    assert near.bulk is not None
    assert far.bulk is not None
    assert far.bulk.mean == pytest.approx(near.bulk.mean, abs=1e-9)
    assert far.checks["momentum"] <= 1e-12
