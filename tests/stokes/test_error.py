"""Error bars bracket the true error and are close to it; a tolerance is reached, or refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gmsh
import numpy as np
import pytest
from numpy.testing import assert_array_equal

from fsi.case.case import Case
from fsi.case.checks.work import bytes_of
from fsi.case.load import load_case, parse_case
from fsi.errors import SolveError
from fsi.integration.errors import ErrorEstimate
from fsi.lubrication import exact, spheres
from fsi.meshes.files.write import write_mesh
from fsi.observables.scales import flow_scales, relative_change
from fsi.stokes import adapt
from fsi.stokes.adapt import solve_with_errors
from fsi.stokes.comparisons import comparisons
from fsi.stokes.meshes import CaseMeshes
from fsi.stokes.model import StokesModel
from tests.stokes.test_periodic import THREE_IN_A_CELL

CASES = Path(__file__).parents[2] / "cases"


def beside_plane(gap: float, *overrides: str) -> Case:
    return load_case(
        CASES / "disc_beside_plane.toml", [f"bodies.0.position=[0.0, {1.0 + gap!r}]", *overrides]
    )


# Cells around the disc, across a gap, and growth: on the usual mesh degrees 5 and 6 err by rounding.
FEWER_CELLS = {5: (20, 0.3, 0.5), 6: (16, 0.25, 0.7)}


@pytest.mark.parametrize("degree", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("gap", [1.0, 1e-2, 1e-4])
def test_the_bar_of_a_disc_is_between_the_true_error_and_twice_it(gap: float, degree: int) -> None:
    """The truncation at R = 1e5 a is below 1e-9; without SAFETY the bar would be 1 to 3 % too small."""
    names = ("cells_per_circle", "cells_per_gap", "growth")
    sizes = [
        f"discretisation.{name}={size}"
        for name, size in zip(names, FEWER_CELLS.get(degree, ()), strict=False)
    ]
    case = beside_plane(gap, f"discretisation.degree={degree}", *sizes, "domain.radius=1e5")
    solved = solve_with_errors(case)
    true = abs(-solved.solution.F[0, 1] / exact.normal_resistance(gap, 1.0, 1.0) - 1.0)
    bar = solved.errors.F[0, 1] / abs(solved.solution.F[0, 1])
    assert true < bar < 2.0 * true


@pytest.mark.parametrize("name", ["disc_beside_plane", pytest.param("cubic_array", marks=pytest.mark.slow)])
def test_a_step_and_its_bars_take_the_same_straight_cells(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """gmsh works once; the bars are those of a model that has made none before. A step has its own cells."""
    case = load_case(CASES / f"{name}.toml")
    q, generated = case.configuration(), list[int]()
    generate = gmsh.model.mesh.generate

    def counted(dimension: int) -> None:
        generated.append(dimension)
        generate(dimension)

    monkeypatch.setattr(gmsh.model.mesh, "generate", counted)
    model, other = StokesModel(case), StokesModel(case)
    instant = model(q, 0.0)
    once = len(generated)
    bars = model.errors(q, 0.0, instant).errors
    of_edges = sum(each.finer != 1.0 for each in comparisons(case))  # these have other sizes
    assert len(generated) == once * (1 + of_edges)
    assert_array_equal(bars.F, other.errors(q, 0.0, instant).errors.F)
    before = len(generated)
    model(q, 0.0)
    assert len(generated) == before + once


def test_the_bar_of_a_sphere() -> None:
    case = load_case(CASES / "validation/sphere_wall_normal.toml")
    solved = solve_with_errors(case)
    R = float(spheres.normal_resistance(case.bodies[0].position[1] - 1.0, 1.0, 1.0))
    true = abs(-solved.solution.F[0, 1] - R)
    assert true < solved.errors.F[0, 1] < 2.0 * true
    assert solved.errors.F[0, 0] == solved.errors.F[0, 2] == 0.0  # no such modes


def test_the_bar_of_a_free_velocity() -> None:
    solved = solve_with_errors(load_case(CASES / "free_disc_in_shear.toml", ["domain.radius=1e5"]))
    velocity, _ = exact.free_in_shear(0.1, 1.0, 1.0)
    true = abs(solved.solution.U[0, 0] - velocity)
    assert true < solved.errors.U[0, 0] < 2.0 * true
    assert not solved.errors.F.any()  # the loads are given


def test_velocities_that_vanish_by_symmetry_do_not_miss_a_tolerance() -> None:
    """A disc pressed against a wall slides and turns by errors of the mesh alone: 1.5 over themselves."""
    case = load_case(
        CASES / "disc_in_box.toml",
        [
            'bodies.0.velocity=["free", -1.0]',
            'bodies.0.angular_velocity="free"',
            "discretisation.cells_per_circle=24",
            "discretisation.growth=0.5",
            "discretisation.tolerance=1e-3",
        ],
    )
    solved = solve_with_errors(case)
    assert solved.error <= 1e-3
    assert np.all(np.abs(solved.solution.U[0, [0, 2]]) <= 10.0 * solved.errors.U[0, [0, 2]])


@pytest.mark.parametrize(("room", "tried"), [(1.0, 1), (1.12, 2)])
def test_a_mesh_that_memory_has_no_room_for_is_not_tried(
    room: float, tried: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The refusal says how near the last one came, and so which tolerance can be had.

    room: over what the first flow with one degree more needs, (16 + 9/2) / (9 + 4/2) times the unknowns; more
    cells around the disc ask for 1.11 times that, a slower growth for 1.13, more in the gap for 1.98.
    """
    sizes = ["cells_per_circle=24", "growth=0.5", "tolerance=1e-9"]
    case = load_case(CASES / "disc_in_box.toml", [f"discretisation.{size}" for size in sizes])
    rough, solves = solve_with_errors(without_tolerance(case)), list[Case]()
    monkeypatch.setattr("fsi.stokes.adapt.memory", lambda: room * 20.5 / 11.0 * bytes_of(case, rough.dofs))
    monkeypatch.setattr("fsi.stokes.adapt.ROUNDS", 1)
    solved = adapt._solved

    def counted(case: Case, *given: Any) -> adapt.Solved:
        solves.append(case)
        return solved(case, *given)

    monkeypatch.setattr("fsi.stokes.adapt._solved", counted)
    with pytest.raises(SolveError, match=r"and a finer mesh needs some .* of memory") as refused:
        solve_with_errors(case)
    assert len(solves) == tried
    reached = float(str(refused.value).split("came down to ")[1].split(",")[0])
    sizes[-1] = f"tolerance={1.1 * reached!r}"
    again = load_case(CASES / "disc_in_box.toml", [f"discretisation.{size}" for size in sizes])
    assert solve_with_errors(again).error <= 1.1 * reached


def without_tolerance(case: Case) -> Case:
    return case.model_copy(
        update={"discretisation": case.discretisation.model_copy(update={"tolerance": None})}
    )


def test_a_mesh_of_the_user_is_not_refined(tmp_path: Path) -> None:
    """Eight rounds of finer sizes changed nothing, and the complaint was about them."""
    coarse = ["discretisation.cells_per_circle=12", "discretisation.growth=1.0", "discretisation.degree=2"]
    case = load_case(CASES / "disc_in_box.toml", coarse)
    write_mesh(CaseMeshes(case).mesh(case.configuration()), tmp_path / "mine.msh", case.names)
    own = [*coarse, f'domain.mesh="{tmp_path}/mine.msh"', "discretisation.tolerance=1e-9"]
    with pytest.raises(SolveError, match=r"on the mesh of domain\.mesh.* not refined.* give a finer mesh"):
        solve_with_errors(load_case(CASES / "disc_in_box.toml", own))


@pytest.mark.parametrize(
    ("domain", "velocity"),
    [
        ({"shape": "cell", "vectors": [[9.0, 0.0], [0.0, 9.0]], "extension": -2.0}, 1.0),
        ({"lower": [-3.0, 0.0], "upper": [0.0, 4.0], "walls": {"top": [3.0, 0.0]}}, 0.3),
        ({"shape": "half-plane", "radius": 1e5, "walls": {"far": {"shear": 4.0}}}, 2.0),
    ],
)
def test_flows_without_moving_bodies_have_a_velocity_to_compare_with(
    domain: dict[str, object], velocity: float
) -> None:
    """Rate of shear times radius, a wall of speed 3 in a box of size 5 shearing at the rate 0.6."""
    body = {"name": "disc", "radius": 0.5, "position": [-1.5, 2.0]}
    case = parse_case({"name": "x", "fluid": {"viscosity": 3.0}, "domain": domain, "bodies": [body]})
    scales = flow_scales(case, 0.0)
    assert scales.velocity == pytest.approx(velocity, rel=1e-14)
    assert scales.resistance == 3.0
    noise = ErrorEstimate(np.full((1, 3), 1e-9), np.full((1, 3), 1e-9))
    held = np.array([[True, False, False]])
    found = relative_change(noise, noise, held, np.ones((1, 3)), scales)
    assert found["velocity"] == pytest.approx(1e-7 / velocity)
    assert found["force"] == pytest.approx(1e-7 / (3.0 * velocity))


def test_errors_are_those_of_results_and_never_below_rounding() -> None:
    case = load_case(CASES / "disc_in_box.toml", ["discretisation.degree=2"])
    model, q = StokesModel(case), case.configuration()
    better = model.of_degree(4, q, 0.0, case.motion(0.0))
    errors = model.errors(q, 0.0, better).errors
    assert not errors.U.any()
    np.testing.assert_allclose(errors.F[0], 1e-11 * np.abs(better.F).max(), rtol=1e-12)


def test_a_tolerance_refines_until_it_is_reached() -> None:
    """A coarse mesh is ten times off the tolerance; the result must then be as accurate as it says."""
    coarse = ("discretisation.cells_per_circle=12", "discretisation.growth=0.8", "discretisation.degree=2")
    plain = solve_with_errors(beside_plane(0.1, *coarse))
    refined = solve_with_errors(beside_plane(0.1, *coarse, "discretisation.tolerance=1e-4"))
    assert plain.error > 1e-3
    assert refined.error <= 1e-4
    assert refined.solution.cells > plain.solution.cells
    assert refined.case.discretisation.cells_per_gap > 1.0
    true = abs(-refined.solution.F[0, 1] / exact.normal_resistance(0.1, 1.0, 1.0) - 1.0)
    assert true <= 1e-4


def test_a_tolerance_out_of_reach_says_what_was_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fsi.stokes.adapt.MOST_UNKNOWNS", 5000)
    case = load_case(CASES / "disc_in_box.toml", ["discretisation.degree=2", "discretisation.tolerance=1e-9"])
    with pytest.raises(SolveError, match=r"tolerance = 1e-09: the estimated error came down to .* unknowns"):
        solve_with_errors(case)


def test_the_tolerance_is_that_of_the_apparent_viscosity_too() -> None:
    """A disc of a square lattice turns with the mean flow, by symmetry: its velocity says nothing."""
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 0.0]}
    domain = {"shape": "cell", "vectors": [[2.2, 0.0], [0.0, 2.2]], "shear": 1.0}
    coarse = {"cells_per_gap": 0.3, "cells_per_circle": 12, "growth": 1.0}
    data = {"name": "t", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": [body]}
    plain, refined = (
        solve_with_errors(parse_case(data | {"discretisation": coarse | more}))
        for more in ({}, {"tolerance": 1e-5})
    )
    for solved in (plain, refined):
        bar, mu = solved.errors.apparent_viscosity, solved.solution.apparent_viscosity
        assert bar is not None
        assert mu is not None
        assert solved.error >= bar / mu
    assert plain.error > 1e-5 >= refined.error


@pytest.mark.parametrize("more", [{}, {"degree": 2, "cells_per_circle": 20}])
def test_the_bar_of_the_apparent_viscosity_holds_the_true_error(more: dict[str, object]) -> None:
    """Three discs in an oblique cell, whose viscosity is known to 1e-12 from `test_periodic`."""
    discs = [
        {"name": f"d{k}", "radius": a, "position": [x, y]} for k, (x, y, a) in enumerate(THREE_IN_A_CELL)
    ]
    data = {
        "name": "t", "fluid": {"viscosity": 1.0}, "bodies": discs,
        "domain": {"shape": "cell", "vectors": [[5.0, 0.0], [0.7, 4.6]], "shear": 1.0},
        "discretisation": {"cells_per_gap": 0.5, "cells_per_circle": 14, "growth": 0.8} | more,
    }  # fmt: skip
    solved = solve_with_errors(parse_case(data))
    bar, mu = solved.errors.apparent_viscosity, solved.solution.apparent_viscosity
    assert bar is not None
    assert mu is not None
    true = abs(mu - 1.4958338873024166)
    assert true <= bar <= 3.0 * true
