"""Walls of a channel, and cells, that a stress moves: how fast they slide or are sheared is a result."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.errors import InputError
from fsi.models import make_evolution
from fsi.postprocess.analysis.chains import read_chains
from fsi.postprocess.analysis.strain import shear_rate
from fsi.postprocess.run.run import open_run
from fsi.runs import resume, run
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution
from tests.small_run import break_off

CASE = Path(__file__).parents[2] / "cases" / "couette_N10.toml"
LIGHT = [f"discretisation.{size}" for size in ("degree=2", "cells_per_circle=12", "growth=0.8")]
VISCOSITY, STRESS = 3.0, 0.7


def solved(top: str, *more: str) -> StokesSolution:
    """Ten discs; the other wall moves too, so that its speed and the rate are not the same."""
    walls = ["domain.walls.bottom=[0.2, 0.0]", f"domain.walls.top={top}"]
    case = load_case(CASE, [*walls, f"fluid.viscosity={VISCOSITY}", *LIGHT, *more])
    return StokesModel(case)(case.configuration(), 0.0)


@pytest.mark.parametrize("formulation", ["eliminated", "multiplier"])
def test_the_rate_is_the_stress_over_the_apparent_viscosity(formulation: str) -> None:
    """Of the flow whose rate is given; both are the same flow but for a factor, seen from the bottom."""
    more = [f"discretisation.formulation={formulation}"]
    given, found = solved("[1.0, 0.0]", *more), solved(f"{{stress = {STRESS}}}", *more)
    height = found.problem.container.volume / found.problem.container.periods[0, 0]
    rate = (found.wall_speeds["top"] - 0.2) / height
    assert given.bulk is not None
    assert found.bulk is not None
    assert given.bulk.apparent_viscosity is not None
    assert rate == pytest.approx(STRESS / (VISCOSITY * given.bulk.apparent_viscosity), rel=1e-8)
    assert found.bulk.apparent_viscosity == pytest.approx(given.bulk.apparent_viscosity, rel=1e-8)
    assert found.bulk.mean[0, 1] == pytest.approx(STRESS, rel=1e-8)
    factor = rate * height / 0.8
    moved = np.array([0.2, 0.0, 0.0])
    np.testing.assert_allclose(found.U - moved, factor * (given.U - moved), rtol=0.0, atol=1e-9)
    above = np.array([[1.0, found.problem.container.middle[1] + 0.5 * height]])
    assert found.velocity(above)[0, 0] == pytest.approx(found.wall_speeds["top"], rel=1e-10)


CELL = CASE.with_name("sheared_cell.toml")


def in_cell(*changes: str, case: Path = CELL) -> StokesSolution:
    """The flow of three discs in a cell."""
    sheared = load_case(case, [f"fluid.viscosity={VISCOSITY}", *changes])
    return StokesModel(sheared)(sheared.configuration(), 0.0)


DRIVEN = ["domain.shear=0.0", f"domain.stress={STRESS}"]


@pytest.mark.parametrize("formulation", ["eliminated", "multiplier"])
def test_the_rate_of_a_cell_is_the_stress_over_the_apparent_viscosity(formulation: str) -> None:
    """Of the cell whose rate is given: both are the same flow but for a factor, the rate."""
    more = [f"discretisation.formulation={formulation}"]
    given, found = in_cell("domain.shear=1.0", *more), in_cell(*DRIVEN, *more)
    rate = found.shear_rate
    assert rate is not None
    assert rate == pytest.approx(STRESS / (VISCOSITY * (given.apparent_viscosity or 0.0)), rel=1e-8)
    assert found.apparent_viscosity == pytest.approx(given.apparent_viscosity, rel=1e-8)
    assert found.bulk is not None
    assert found.bulk.mean[0, 1] == pytest.approx(STRESS, rel=1e-8)
    np.testing.assert_allclose(found.U, rate * given.U, rtol=0.0, atol=1e-9)
    images = np.array([[2.0, 9.0], [-3.0, 2.5]])
    np.testing.assert_allclose(found.velocity(images), rate * given.velocity(images), rtol=0.0, atol=1e-9)
    assert found.record["shear_rate"] == rate


def test_a_cell_under_a_stress_with_bodies_that_are_held_and_pushed() -> None:
    """The cell that is sheared at the rate that was found is the same flow; a force of another body is not
    taken for the stress, nor is what attraction carries counted twice."""
    pull = '{kind="attraction", law="exponential", strength=2.0, length=0.5, cutoff=3.0}'
    loads = ["bodies.0.velocity=[0.3, 'free']", "bodies.1.force=[0.4, 0.0]", "bodies.1.torque=0.5"]
    loads.append(f"forces=[{pull}]")
    found = in_cell(*DRIVEN, *loads)
    assert found.bulk is not None
    assert abs(found.bulk.forces[0, 1]) > 0.01  # what the attraction carries
    assert found.bulk.mean[0, 1] == pytest.approx(STRESS, rel=1e-8)
    again = in_cell(f"domain.shear={found.shear_rate!r}", *loads)
    np.testing.assert_allclose(found.U, again.U, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(found.F, again.F, rtol=0.0, atol=1e-9)
    assert again.bulk is not None
    np.testing.assert_allclose(found.bulk.mean, again.bulk.mean, rtol=0.0, atol=1e-8)


@pytest.mark.slow
def test_a_cell_of_space_under_a_stress() -> None:
    """Sigma_xz over mu and the apparent viscosity of the cell whose rate is given, as in the plane."""
    case = CASE.with_name("sheared_spheres.toml")
    light = ["discretisation.solver=direct", "discretisation.cells_per_circle=8", "discretisation.degree=2"]
    given = in_cell(*light, case=case)
    found = in_cell(*DRIVEN, *light, case=case)
    assert given.apparent_viscosity is not None
    assert found.shear_rate == pytest.approx(STRESS / (VISCOSITY * given.apparent_viscosity), rel=1e-8)


@pytest.mark.slow
def test_a_wall_in_space_under_a_stress() -> None:
    """One sphere between plates: what the top is pulled by is the viscosity times the rate."""
    data: dict[str, Any] = {
        "name": "plates", "geometry": "spatial", "fluid": {"viscosity": VISCOSITY},
        "domain": {"lower": [0.0] * 3, "upper": [4.0, 4.0, 3.5], "periodic": ["x", "y"]},
        "bodies": [{"name": "ball", "radius": 1.0, "position": [2.0, 2.0, 1.9]}],
        "discretisation": {"degree": 2, "cells_per_circle": 8, "growth": 1.0, "solver": "direct"},
    }  # fmt: skip
    found, given = (
        StokesModel(case)(case.configuration(), 0.0)
        for top in ({"stress": STRESS}, [1.0, 0.0, 0.0])
        for case in [parse_case(data | {"domain": data["domain"] | {"walls": {"top": top}}})]
    )
    assert given.apparent_viscosity is not None
    rate = found.wall_speeds["top"] / 3.5
    assert rate == pytest.approx(STRESS / (VISCOSITY * given.apparent_viscosity), rel=1e-8)


def test_cells_under_a_stress_are_refused_where_nothing_would_follow_it(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"domain\.stress = 0\.7: a rate of shear is given too"):
        load_case(CELL, [f"domain.stress={STRESS}"])
    with pytest.raises(InputError, match=r'model = "reduced" is not moved by a stress; give domain\.shear'):
        load_case(CELL, [*DRIVEN, "model=reduced"])
    with pytest.raises(InputError, match=r"a run under domain\.stress = 0\.7 does not tell"):
        run(load_case(CELL, [*DRIVEN, "output.error_estimates=true"]), tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_run_of_a_cell_under_a_stress_goes_on_as_if_it_had_not_been_broken_off(tmp_path: Path) -> None:
    """Its lattice and the mesh that moves with it too; at each step the rate is the stress over viscosity."""
    light = ["discretisation.degree=2", "discretisation.cells_per_circle=10"]
    of_run = ["time={end=1.5, tolerance=1e-2, first_step=0.5, remesh='when-needed'}", "output.fields=false"]
    case = load_case(CELL, [*DRIVEN, f"fluid.viscosity={VISCOSITY}", *light, *of_run])
    run(case, tmp_path / "whole")
    break_off(tmp_path / "broken", case, 1, make_evolution)
    resume(tmp_path / "broken")
    whole, broken = (open_run(tmp_path / name) for name in ("whole", "broken"))
    table, again = whole.steps, broken.steps
    assert len(table) >= 3
    for column in ("t", "strain", "shear_rate", "apparent_viscosity", "smallest_gap"):
        np.testing.assert_array_equal(table[column], again[column])
    expected = STRESS / VISCOSITY
    np.testing.assert_allclose(table["shear_rate"] * table["apparent_viscosity"], expected, rtol=1e-8)
    assert table["power"].max() < 1e-8
    last = int(table["step"].iloc[-1])
    assert whole.configuration(last).strain == table["strain"].iloc[-1] > 0.1
    np.testing.assert_allclose(whole.container(last).mean_gradient[0, 1], table["shear_rate"].iloc[-1])
    with pytest.raises(InputError, match=r"domain\.stress = 0\.7: links to images that a stress moves"):
        read_chains(whole)


def channel(bodies: list[dict[str, Any]], stress: Any, **more: Any) -> Case:
    """A channel of height 5 whose bottom is at rest."""
    return parse_case(
        {
            "name": "a channel", "fluid": {"viscosity": VISCOSITY}, "bodies": bodies,
            "discretisation": {"degree": 2, "cells_per_circle": 12, "growth": 0.8},
            "domain": {
                "lower": [0.0, 0.0], "upper": [8.0, 5.0], "periodic": ["x"],
                "walls": {"top": {"stress": stress}}, **more.pop("domain", {}),
            },
        } | more
    )  # fmt: skip


def test_a_pressure_gradient_and_a_stress_drive_together() -> None:
    """Without bodies mu u' = stress - G (H - y), so that the top slides at (stress H - G H^2 / 2) / mu."""
    H, G = 5.0, 0.3
    case = channel([], STRESS, domain={"pressure_gradient": G})
    found = StokesModel(case)(case.configuration(), 0.0)
    assert found.wall_speeds["top"] == pytest.approx((STRESS * H - 0.5 * G * H * H) / VISCOSITY, rel=1e-9)


def test_a_run_under_a_stress_that_grows(tmp_path: Path) -> None:
    """At each step the speed times the apparent viscosity is the stress times height over viscosity."""
    disc = {"name": "disc", "radius": 1.0, "position": [4.0, 2.0]}
    grows = {"times": [0.0, 1.0], "values": [0.0, STRESS]}
    time = {"end": 2.0, "first_step": 1.0, "tolerance": 0.1}
    case = channel([disc], grows, time=time, output={"fields": False})
    run(case, tmp_path / "run")
    table = np.genfromtxt(tmp_path / "run" / "steps.csv", delimiter=",", names=True)
    assert table["speed_top"][0] == 0.0
    assert shear_rate(case, 1.0) is None  # the case does not know it
    expected = STRESS * np.minimum(table["t"], 1.0)[1:] * 5.0 / VISCOSITY
    assert len(expected) >= 2
    assert np.all(table["apparent_viscosity"][1:] > 1.0)
    np.testing.assert_allclose(
        table["speed_top"][1:] * table["apparent_viscosity"][1:], expected, rtol=1e-8, atol=0.0
    )


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (["domain.walls.bottom={stress = 1.0}"], "so has the other wall, but one of them must be given"),
        (["model=reduced"], 'model = "reduced" is not moved by a stress; give a velocity'),
        (["domain.walls.top={stress = 1.0, pressure = 2.0}"], "unknown key"),
        (["domain.walls.top={stress = [1.0, 0.0]}"], "domain.walls.top.stress"),
    ],
)
def test_what_a_stress_does_not_move_is_refused(changes: list[str], said: str) -> None:
    with pytest.raises(InputError, match=r"domain\.walls") as refused:
        load_case(CASE, ["domain.walls.top={stress = 1.0}", *changes])
    assert said in str(refused.value)


def test_a_box_has_no_wall_that_a_stress_moves() -> None:
    with pytest.raises(InputError, match=r"a stress moves only walls of channels; give a velocity"):
        load_case(CASE.with_name("disc_in_box.toml"), ["domain.walls.top={stress = 1.0}"])
