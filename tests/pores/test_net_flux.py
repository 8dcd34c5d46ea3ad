"""Channels of pores tell the mean pressure gradient where their flux is given, else the flux; with bars."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import fsi
from fsi.pores.instant import PoreInstant
from fsi.report.pores import solution_json
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


def test_the_flux_is_that_of_the_resolved_flow_within_its_bar() -> None:
    case = fsi.make_case(**channel(pressure_gradient=GRADIENT))
    pores, resolved = fsi.solve(case), fsi.solve(fsi.make_case(**case.as_data() | {"model": "resolved"}))
    assert pores.errors is not None
    assert resolved.errors is not None
    assert pores.flux is not None
    assert resolved.flux is not None
    assert pores.errors.flux is not None
    assert resolved.errors.flux is not None
    assert abs(pores.flux - resolved.flux) < pores.errors.flux + resolved.errors.flux
    assert pores.errors.flux < 1e-2 * pores.flux


def test_the_gradient_is_that_of_the_resolved_flow_within_its_bar() -> None:
    """A flux the other way too: dp/dx has its sign."""
    for Q in (-1.5, 1.5):
        case = fsi.make_case(**channel(net_flux=Q))
        pores, resolved = fsi.solve(case), fsi.solve(fsi.make_case(**case.as_data() | {"model": "resolved"}))
        assert pores.errors is not None
        assert resolved.errors is not None
        assert pores.dp_dx is not None
        assert resolved.dp_dx is not None
        assert pores.errors.dp_dx is not None
        assert resolved.errors.dp_dx is not None
        assert Q * pores.dp_dx < 0.0
        assert abs(pores.dp_dx - resolved.dp_dx) < pores.errors.dp_dx + resolved.errors.dp_dx
        assert pores.errors.dp_dx < 1e-2 * abs(pores.dp_dx)


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
