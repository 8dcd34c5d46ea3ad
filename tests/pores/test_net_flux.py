"""Channels of pores tell the mean pressure gradient where their flux is given, else the flux; with bars."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import fsi
from fsi.pores.instant import PoreInstant
from fsi.report.pores import solution_json
from fsi.studies.evaluate import of_motion
from fsi.studies.search import trial_of
from tests.net_flux import require_told

LENGTH, GRADIENT = 5.0, -0.7


def channel(**drive: float) -> dict[str, Any]:
    """Two discs between walls at rest."""
    return {
        "name": "a channel", "model": "pores", "fluid": {"viscosity": 2.0}, "pores": {"modes": 4},
        "domain": {"lower": [0.0, 0.0], "upper": [LENGTH, 4.0], "periodic": ["x"], **drive},
        "bodies": [
            {"name": "one", "radius": 1.0, "position": [1.6, 1.5]},
            {"name": "other", "radius": 0.8, "position": [3.9, 2.4]},
        ],
    }  # fmt: skip


def test_the_gradient_of_a_flux_is_the_one_that_drives_it() -> None:
    """The flux of a gradient G takes all of the power, which is -G times length and flux."""
    driven = fsi.solve(fsi.make_case(**channel(pressure_gradient=GRADIENT)))
    assert isinstance(driven.instant, PoreInstant)
    assert driven.dp_dx is None
    assert "pressure_gradient" not in driven.instant.record
    assert driven.flux == pytest.approx(driven.dissipation / (-GRADIENT * LENGTH), rel=1e-9)
    assert driven.instant.record["flux"] == driven.flux
    solution = fsi.solve(fsi.make_case(**channel(net_flux=driven.flux)))
    require_told(solution, GRADIENT, 1e-8, solution_json)
    assert solution.flux is None
    trial = trial_of(driven.case, 0.0, "flux")  # of `fsi search`
    assert driven.errors is not None
    assert (trial.quantity, trial.error) == pytest.approx((driven.flux, driven.errors.flux), rel=1e-9)


def agreed(name: str, **drive: float) -> float:
    """A number of the pores that is within both bars of that of the resolved flow, its own below 1e-2."""
    case = fsi.make_case(**channel(**drive))
    pores, resolved = fsi.solve(case), fsi.solve(fsi.make_case(**case.as_data() | {"model": "resolved"}))
    found, exact = (float(getattr(solution, name)) for solution in (pores, resolved))
    bar, of_exact = (float(getattr(solution.errors, name)) for solution in (pores, resolved))
    assert abs(found - exact) < bar + of_exact
    assert bar < 1e-2 * abs(found)
    return found


def test_the_flux_is_that_of_the_resolved_flow_within_its_bar() -> None:
    assert GRADIENT * agreed("flux", pressure_gradient=GRADIENT) < 0.0


def test_the_gradient_is_that_of_the_resolved_flow_within_its_bar() -> None:
    """A flux the other way too: dp/dx has its sign."""
    for Q in (-1.5, 1.5):
        assert Q * agreed("dp_dx", net_flux=Q) < 0.0


def test_a_run_has_the_gradient_of_every_step(tmp_path: Path) -> None:
    """At the first step that of the instant."""
    case = fsi.make_case(
        **channel(net_flux=1.5), time={"end": 0.2, "first_step": 0.2, "tolerance": 0.1},
        output={"fields": False, "error_estimates": True},
    )  # fmt: skip
    steps, solution = fsi.run(case, tmp_path / "run").steps, fsi.solve(case)
    assert solution.errors is not None
    assert steps["pressure_gradient"][0] == pytest.approx(solution.dp_dx, rel=1e-9)
    assert steps["err_pressure_gradient"][0] == pytest.approx(solution.errors.dp_dx, rel=1e-3)
    mean = of_motion(case, tmp_path / "run", ["pressure gradient"])["pressure gradient"]
    assert steps["pressure_gradient"].min() <= mean.value <= steps["pressure_gradient"].max()
