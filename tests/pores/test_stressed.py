"""Pores whose walls or cell a stress moves: the speed is a result."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.pores import definite
from fsi.pores.accuracy import solve_with_errors
from fsi.pores.bars import CHANCE
from fsi.pores.instant import PoreInstant
from fsi.pores.model import PoreModel
from fsi.postprocess.run.run import Run, open_run
from fsi.runs import run
from fsi.studies.evaluate import at_instant, require_quantity

CASES = Path(__file__).parents[2] / "cases"
CHANNEL, CELL = CASES / "couette_N10.toml", CASES / "sheared_cell.toml"
VISCOSITY, STRESS = 3.0, 0.7
BOTTOM = 0.2


def solved(case: Path, *changes: str) -> PoreInstant:
    """The flow through pores."""
    pores = load_case(case, ["model=pores", f"fluid.viscosity={VISCOSITY}", *changes])
    return PoreModel(pores)(pores.configuration(), 0.0)


def test_the_rate_of_a_channel_is_the_stress_over_the_apparent_viscosity() -> None:
    """Of the flow whose rate is given, seen from the bottom; one period is 8.86 long and as high."""
    walls = [f"domain.walls.bottom=[{BOTTOM}, 0.0]"]
    given = solved(CHANNEL, *walls, "domain.walls.top=[1.0, 0.0]")
    found = solved(CHANNEL, *walls, f"domain.walls.top={{stress = {STRESS}}}")
    container = found.bodies.case.container()
    height = container.volume / container.periods[0, 0]
    rate, mu = (found.wall_speeds["top"] - BOTTOM) / height, given.apparent_viscosity
    assert mu is not None
    assert rate == pytest.approx(STRESS / (VISCOSITY * mu), rel=1e-8)
    assert found.bulk is not None
    assert found.bulk.mean[0, 1] == pytest.approx(STRESS, rel=1e-8)
    moved = np.array([BOTTOM, 0.0, 0.0])
    factor = rate * height / (1.0 - BOTTOM)
    np.testing.assert_allclose(found.U - moved, factor * (given.U - moved), rtol=0.0, atol=1e-9)


def test_a_pressure_gradient_and_a_stress_drive_together() -> None:
    """The wall that slides as was found feels the stress, and the flow is the same."""
    more = ["domain.pressure_gradient=0.3", "domain.walls.bottom=[0.2, 0.0]", "bodies.0.force=[0.5, 0.1]"]
    found = solved(CHANNEL, f"domain.walls.top={{stress = {STRESS}}}", *more)
    again = solved(CHANNEL, f"domain.walls.top=[{found.wall_speeds['top']!r}, 0.0]", *more)
    container = found.bodies.case.container()
    top = container.walls.index("top")
    force = STRESS * container.periods[0, 0]
    assert again.flow.wall_forces[top, 0] == pytest.approx(force, rel=1e-7)
    np.testing.assert_allclose(found.U, again.U, rtol=0.0, atol=1e-9)


def test_a_stress_takes_one_set_of_factors(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its three flows, without the wall, of the wall alone and of both, have one matrix."""
    made = []

    def counted(lower: Any) -> Any:
        made.append(lower.size)
        return factors(lower)

    factors = definite._factors
    monkeypatch.setattr(definite, "_factors", counted)
    solved(CHANNEL, f"domain.walls.top={{stress = {STRESS}}}")
    assert len(made) == 1


@pytest.mark.parametrize("modes", [1, 4])
def test_the_rate_of_a_cell_is_the_stress_over_the_apparent_viscosity(modes: int) -> None:
    more = [f"pores.modes={modes}"]
    given = solved(CELL, *more)
    found = solved(CELL, "domain.shear=0.0", f"domain.stress={STRESS}", *more)
    rate, mu = found.shear_rate, given.apparent_viscosity
    assert rate is not None
    assert mu is not None
    assert rate == pytest.approx(STRESS / (VISCOSITY * mu), rel=1e-8)
    np.testing.assert_allclose(found.U, rate * given.U, rtol=0.0, atol=1e-9)
    assert found.lower_bound == pytest.approx(given.lower_bound, rel=1e-8)


def test_attraction_carries_a_part_of_the_stress_of_a_cell() -> None:
    pull = '{kind="attraction", law="exponential", strength=2.0, length=0.5, cutoff=3.0}'
    found = solved(CELL, "domain.shear=0.0", f"domain.stress={STRESS}", f"forces=[{pull}]")
    assert found.bulk is not None
    assert abs(found.bulk.forces[0, 1]) > 0.01
    assert found.bulk.mean[0, 1] == pytest.approx(STRESS, rel=1e-8)


def test_the_rate_of_a_cell_has_a_bar_and_a_name() -> None:
    """Six modes are off by less than the bar; a wall has them too."""
    cell = ["model=pores", f"fluid.viscosity={VISCOSITY}", "domain.shear=0.0", f"domain.stress={STRESS}"]
    case = load_case(CELL, cell)
    found = at_instant(case, ["shear rate"]).values["shear rate"]
    finer = solved(CELL, *cell[2:], "pores.modes=6").shear_rate
    assert finer is not None
    assert found.error is not None
    assert abs(found.value - finer) < found.error < 0.1 * found.value
    channel = load_case(CHANNEL, ["model=pores", f"domain.walls.top={{stress = {STRESS}}}"])
    top = at_instant(channel, ["wall speed"]).values["wall speed"]
    assert top.error is not None
    assert 0.0 < top.error < 0.1 * abs(top.value)
    for case, quantity, remedy in (
        (channel, "shear rate", "give domain.stress"),
        (load_case(CELL), "wall speed", "give domain.walls.top"),
    ):
        with pytest.raises(InputError, match=rf"--quantity {quantity}: .*{remedy}"):
            require_quantity(case, quantity)


def test_with_a_tolerance_both_flows_that_are_compared_have_the_stress() -> None:
    changes = ["model=pores", "domain.shear=0.0", f"domain.stress={STRESS}", "pores.tolerance=1e-4"]
    found = solve_with_errors(load_case(CELL, changes))
    mu, bar, of_stress = (
        found.solution.apparent_viscosity,
        found.errors.apparent_viscosity,
        found.errors.stress,
    )
    assert mu is not None
    assert bar is not None
    assert of_stress is not None
    assert 1e-6 * mu < bar < 1e-4 * mu
    # What is given has the least bar there is, a part of the largest of its kind.
    assert of_stress.mean[0, 1] == pytest.approx(CHANCE * of_stress.mean[0, 0], rel=1e-6)
    assert of_stress.mean[0, 0] > 1e-8


def test_a_run_under_a_stress(tmp_path: Path) -> None:
    """At each step the speed times the apparent viscosity is the stress times height over viscosity."""
    changes = ["model=pores", f"domain.walls.top={{stress = {STRESS}}}", "domain.walls.bottom=[0.0, 0.0]"]
    case = load_case(CHANNEL, [*changes, "time={end=2.0, tolerance=0.05}", "output.fields=false"])
    run(case, tmp_path / "run")
    table = np.genfromtxt(tmp_path / "run" / "steps.csv", delimiter=",", names=True)
    container = case.container()
    expected = STRESS * container.volume / container.periods[0, 0] / case.fluid.viscosity
    assert len(table) >= 3
    driven = table["speed_top"] * table["apparent_viscosity"]
    np.testing.assert_allclose(driven, expected, rtol=1e-8, atol=0.0)


def test_a_cell_under_a_stress_takes_the_way_of_one_whose_rate_is_given(
    tmp_path: Path,
) -> None:
    """Bodies without loads move with the rate, so that places and viscosity belong to the strain alone.

    The time that a strain takes is the integral of viscosity times apparent viscosity over the stress. Discs
    in a lattice at rest would be off by 0.014, in one that has 0.99 of its strain by 1.6e-4.
    """
    changes = ["model=pores", "pores.modes=1", f"fluid.viscosity={VISCOSITY}", "output.fields=false"]
    found = moved([*changes, "domain.shear=0.0", f"domain.stress={STRESS}"], 2.0, tmp_path / "stress")
    table = found.steps
    strain, mu = table["strain"].to_numpy(), table["apparent_viscosity"].to_numpy()
    np.testing.assert_allclose(table["shear_rate"] * mu, STRESS / VISCOSITY, rtol=1e-8, atol=0.0)
    assert table["power"].max() < 1e-8
    given = moved([*changes, "domain.shear=1.0"], float(strain[-1]), tmp_path / "rate")
    last = [each.configuration(int(each.steps["step"].iloc[-1])) for each in (found, given)]
    np.testing.assert_allclose(last[0].centres, last[1].centres, rtol=0.0, atol=5e-5)
    np.testing.assert_allclose(last[0].angles, last[1].angles, rtol=0.0, atol=5e-5)
    at_strain = given.steps["apparent_viscosity"].to_numpy()
    assert mu[-1] == pytest.approx(at_strain[-1], rel=1e-5)
    time = float(CubicSpline(given.steps["t"], at_strain).integrate(0.0, strain[-1])) * VISCOSITY / STRESS
    assert time == pytest.approx(2.0, rel=5e-3)


def moved(changes: list[str], end: float, folder: Path) -> Run:
    """A run of three discs in a cell."""
    run(load_case(CELL, [*changes, f"time={{end={end!r}, tolerance=1e-4}}"]), folder)
    return open_run(folder)


def test_channels_that_slide_along_as_a_whole_keep_their_digits() -> None:
    """All velocities are those of the channel at rest plus that of the walls."""
    walls = ("domain.walls.bottom=[{}, 0.0]", "domain.walls.top=[{}, 0.0]")
    still = solved(CHANNEL, walls[0].format(0.0), walls[1].format(1.0))
    moved = solved(CHANNEL, walls[0].format(1000.0), walls[1].format(1001.0))
    np.testing.assert_allclose(moved.U - [1000.0, 0.0, 0.0], still.U, rtol=0.0, atol=1e-9)
    assert moved.apparent_viscosity == pytest.approx(still.apparent_viscosity, rel=1e-8)
