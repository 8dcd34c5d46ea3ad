"""Channels tell the mean pressure gradient where their net flux is given, else the net flux; with bars."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

import fsi
from fsi.meshes.geometry.box import Box
from fsi.observables.quantities import computed
from fsi.report.solution import print_solution, solution_json
from fsi.stokes.solution import StokesSolution
from fsi.stokes.solve import DEFAULT, FORMULATIONS, Clock, assembled
from fsi.stokes.solvers.drives import Averages
from fsi.stokes.solvers.periodic import solve_periodic
from fsi.studies.evaluate import require_quantity
from tests.flows import discs
from tests.net_flux import require_told
from tests.periodic import force_free, in_channel

VISCOSITY, HEIGHT, LENGTH, FLUX, SPEED = 3.0, 5.0, 8.0, 1.7, 0.4
# Plane Couette-Poiseuille flow: Q = U H / 2 - G H^3 / (12 mu).
GRADIENT = 12.0 * VISCOSITY * (0.5 * SPEED * HEIGHT - FLUX) / HEIGHT**3


def channel(*bodies: dict[str, Any], **more: Any) -> fsi.Case:
    """The top slides, the bottom rests; degree 2 has a parabola exactly."""
    domain = {"lower": [0.0, 0.0], "upper": [LENGTH, HEIGHT], "periodic": ["x"], "net_flux": FLUX}
    return fsi.make_case(
        name="a channel", fluid={"viscosity": VISCOSITY}, bodies=list(bodies),
        domain=domain | {"walls": {"top": [SPEED, 0.0]}} | more.pop("domain", {}),
        discretisation={"degree": 2, "cells_per_circle": 12, "growth": 0.8}, **more,
    )  # fmt: skip


DISC = {"name": "disc", "radius": 1.0, "position": [4.0, 2.0]}


def test_the_gradient_of_couette_poiseuille_flow_is_found_and_told() -> None:
    """A wrong sign, viscosity or unit of length would be off by as much as it is."""
    solution = fsi.solve(channel())
    found, errors = solution.instant, solution.errors
    assert isinstance(found, StokesSolution)
    assert errors is not None
    require_told(solution, GRADIENT, 1e-9, solution_json)
    require_quantity(solution.case, "pressure gradient")
    assert computed(solution.case, found, "pressure gradient") == pytest.approx(GRADIENT, rel=1e-9)
    assert computed(solution.case, errors, "pressure gradient") == errors.dp_dx
    printed = io.StringIO()
    print_solution(Console(file=printed, width=200), solution.case, found, errors, None)
    assert f"the mean dp/dx is {GRADIENT:.8g} ± {errors.dp_dx:.0e}, as the net" in printed.getvalue()


def test_the_gradient_of_a_flux_is_the_one_that_drives_it() -> None:
    """Beside a disc across the end of a period, by a flux that dp/dx = -0.3 drives."""
    box, q, G = Box((0.0, 0.0), (LENGTH, HEIGHT), periodic=("x",)), discs([(7.9, 2.0)], [1.0]), -0.3
    given = in_channel(box, q, force_free(q), G)
    assert given.dp_dx is None
    found = in_channel(box, q, force_free(q), None, given.flux)
    assert found.dp_dx == pytest.approx(G, rel=1e-9)
    assert found.flux is None


def test_the_flux_is_that_of_fluid_and_bodies() -> None:
    """The mean velocity times the height, but for 5e-7; the disc has a sixth of the channel.

    Nothing else has power: by that of dp/dx it is the dissipation over -dp/dx and a period, to rounding.
    """
    box, q = Box((0.0, 0.0), (LENGTH, HEIGHT), periodic=("x",)), discs([(7.9, 2.0)], [1.5])
    found = in_channel(box, q, force_free(q), -0.3)
    with assembled(found.problem, DEFAULT, Clock()) as system:
        loaded, nodal, _ = solve_periodic(system, FORMULATIONS[DEFAULT.formulation])
        mean = float(Averages(loaded).velocity(nodal, np.zeros((2, 2)))[0])
    assert found.flux == pytest.approx(HEIGHT * mean, rel=1e-6)
    assert found.flux == pytest.approx(found.dissipation / (0.3 * LENGTH), rel=1e-10)


def driven_flux(height: float) -> float:
    """Of Couette-Poiseuille flow, per unit width."""
    return 0.5 * SPEED * height + 0.3 * height**3 / (12.0 * VISCOSITY)


def test_the_flux_of_couette_poiseuille_flow_is_found_and_told() -> None:
    domain = {"lower": [0.0, 0.0], "upper": [LENGTH, HEIGHT], "periodic": ["x"], "pressure_gradient": -0.3}
    data = channel().as_data()
    solution = fsi.solve(fsi.make_case(**data | {"domain": domain | {"walls": {"top": [SPEED, 0.0]}}}))
    found, errors = solution.instant, solution.errors
    assert isinstance(found, StokesSolution)
    assert errors is not None
    assert solution.flux == pytest.approx(driven_flux(HEIGHT), rel=1e-9)
    assert found.record["flux"] == solution.flux
    require_quantity(solution.case, "flux")
    assert computed(solution.case, found, "flux") == solution.flux
    data = solution_json(solution.case, found, errors, None)
    assert (data["flux"], data["flux_error"]) == (solution.flux, errors.flux)
    printed = io.StringIO()
    print_solution(Console(file=printed, width=200), solution.case, found, errors, None)
    assert (
        f"the net flux along x is {driven_flux(HEIGHT):.8g} ± {errors.flux:.0e}, of fluid"
        in printed.getvalue()
    )


def test_the_flux_in_space_is_that_through_a_section_across_x() -> None:
    """Between plates, with images along x and y, in a unit of length that is not 1."""
    width, height = 2.0, 1.5
    domain = {
        "lower": [0.0, 0.0, 0.0], "upper": [3.0, width, height], "periodic": ["x", "y"],
        "pressure_gradient": -0.3, "walls": {"top": [SPEED, 0.0, 0.0]},
    }  # fmt: skip
    solution = fsi.solve(
        fsi.make_case(
            name="plates",
            geometry="spatial",
            fluid={"viscosity": VISCOSITY},
            bodies=[],
            domain=domain,
            discretisation={"degree": 2, "cells_per_circle": 8, "growth": 1.0},
        )
    )
    assert solution.flux == pytest.approx(width * driven_flux(height), rel=1e-6)


def test_the_bar_of_the_gradient_holds_the_one_of_finer_elements() -> None:
    """Degree 2 against 4, some 30 times as good; a bar ten times too long would be seen too."""
    coarse = fsi.solve(channel(DISC))
    fine = fsi.solve(fsi.make_case(**channel(DISC).as_data() | {"discretisation": {"degree": 4}}))
    assert coarse.errors is not None
    assert coarse.errors.dp_dx is not None
    assert coarse.dp_dx is not None
    assert fine.dp_dx is not None
    off = abs(coarse.dp_dx - fine.dp_dx)
    assert 0.1 * coarse.errors.dp_dx < off < coarse.errors.dp_dx


def test_a_run_has_the_gradient_of_every_step_and_its_bar(tmp_path: Path) -> None:
    """The first is that of the instant, but for what rounding leaves of one more solve."""
    time = {"end": 0.2, "first_step": 0.2, "tolerance": 0.1}
    case = channel(DISC, time=time, output={"fields": False, "error_estimates": True})
    steps = fsi.run(case, tmp_path / "run").steps
    solution = fsi.solve(case)
    assert solution.errors is not None
    assert len(steps) >= 2
    assert steps["pressure_gradient"][0] == pytest.approx(solution.dp_dx, rel=1e-9)
    assert steps["err_pressure_gradient"][0] == pytest.approx(solution.errors.dp_dx, rel=1e-3)


def test_where_the_gradient_is_given_none_is_found() -> None:
    domain = {"lower": [0.0, 0.0], "upper": [LENGTH, HEIGHT], "periodic": ["x"], "pressure_gradient": -0.3}
    data = channel().as_data() | {"domain": domain}
    solution = fsi.solve(fsi.make_case(**data))
    assert isinstance(solution.instant, StokesSolution)
    assert solution.dp_dx is None
    assert solution.errors is not None
    assert "pressure_gradient" not in solution.instant.record
    assert fsi.solve(channel()).flux is None
    assert "pressure_gradient" not in solution_json(solution.case, solution.instant, solution.errors, None)


def test_fluid_at_rest_beside_a_narrow_gap_is_a_flow_too() -> None:
    """Nothing is missed, along which refinement could go on: of 0 / 0 there were no singular values."""
    bodies = [DISC | {"position": [2.0, 1.001]}, {"name": "b", "radius": 0.01, "position": [3.01001, 1.001]}]
    domain = {"lower": [0.0, 0.0], "upper": [7.0, 4.0], "periodic": ["x"], "pressure_gradient": 0.0}
    data = {"name": "at rest", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": bodies}
    assert np.all(fsi.solve(fsi.make_case(**data)).instant.U == 0.0)
