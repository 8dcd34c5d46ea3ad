"""The pressure of the stress in equilibrium: that of the resolved flow, in files, probes and pictures too."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import fsi
from fsi.arrays import Array
from fsi.case.case import Case
from fsi.errors import InputError
from fsi.pores import instant
from fsi.pores.instant import PoreInstant
from fsi.pores.narrow import narrowness
from fsi.postprocess.run.probe import probe
from fsi.postprocess.run.run import Run, open_run
from fsi.runs import run
from fsi.stokes.model import StokesModel
from tests.commands import fsi_command

VECTORS = np.array([[5.0, 0.0], [1.0, 4.0]])
BODIES = [
    {"name": "one", "radius": 1.0, "position": [1.6, 1.5]},
    {"name": "other", "radius": 0.7, "position": [3.3, 2.2]},
]


def in_cell(flow: dict[str, float], model: str = "pores", modes: int = 4, **more: Any) -> Case:
    data: dict[str, Any] = {"name": "two", "model": model, "fluid": {"viscosity": 3.0}, "bodies": BODIES}
    data["domain"] = {"shape": "cell", "vectors": VECTORS.tolist()} | flow
    light = {"degree": 4, "cells_per_circle": 16, "growth": 0.7}  # errs by 1e-4
    data |= {"pores": {"modes": modes}} if model == "pores" else {"discretisation": light}
    return fsi.make_case(**data | more)


def between_walls(model: str, **more: Any) -> Case:
    channel = {"lower": [0.0, 0.0], "upper": [5.0, 4.5], "periodic": ["x"], "walls": {"top": [2.0, 0.0]}}
    return in_cell({}, model, 8, domain=channel, **more)


def exact_pressure(case: Case, x: Array) -> Array:
    """Of the resolved flow, without its bars."""
    return StokesModel(case)(case.configuration(), 0.0).evaluate(x)[1]


def off(pores: Case, resolved: Case, x: Array) -> float:
    """The root of the mean square of what pressures differ by at points in the fluid, over that of them."""
    p, exact = fsi.solve(pores).evaluate(x)[1], exact_pressure(resolved, x)
    known = np.isfinite(exact)
    assert np.isfinite(p[known]).mean() > 0.99
    known &= np.isfinite(p)
    assert known.sum() > 30
    return float(np.linalg.norm((p - exact)[known]) / np.linalg.norm(exact[known]))


def points(n: int = 400) -> Array:
    return np.asarray(np.random.default_rng(1).uniform(size=(n, 2)) @ VECTORS)


@pytest.fixture(scope="module")
def sheared(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("pressure") / "run"
    run(in_cell({"shear": 1.0}, time={"end": 0.1, "tolerance": 1e-2}), folder)
    return open_run(folder)


@pytest.mark.parametrize("flow", [{"shear": -2.0}, {"extension": 0.5}])
def test_the_pressure_in_a_cell_is_that_of_the_resolved_flow(flow: dict[str, float]) -> None:
    """Its mean over the fluid is 0, and it is periodic: root mean square errors are 1.5e-2, 2e-3 and 6e-4 of
    it with 1, 4 and 8 modes. With a mean stress of another viscosity it would be off by 2/3."""
    x = points()
    exact = exact_pressure(in_cell(flow, "resolved"), x)
    for modes, most in ((1, 3e-2), (4, 5e-3), (8, 1e-3)):
        solution = fsi.solve(in_cell(flow, modes=modes))
        u, p = solution.evaluate(x)
        assert np.array_equal(np.isfinite(p), np.isfinite(exact))
        assert np.array_equal(u, solution.velocity(x), equal_nan=True)
        known = np.isfinite(p)
        assert np.sqrt(np.mean((p - exact)[known] ** 2)) < most * np.sqrt(np.mean(exact[known] ** 2))
        away = solution.evaluate(x + VECTORS.sum(axis=0))[1]
        np.testing.assert_allclose(away, p, atol=1e-9 * np.abs(exact[known]).max())


def test_the_pressure_between_walls_is_that_of_the_resolved_flow() -> None:
    """Root mean square errors are 2e-4 of it with eight modes; with the other sign they would be 2 of it."""
    x = np.random.default_rng(2).uniform(size=(400, 2)) * [5.0, 4.5]
    assert off(between_walls("pores"), between_walls("resolved"), x) < 1e-3


PUSHED = [
    BODIES[0] | {"force": [1.0, -2.0], "torque": 0.7},
    BODIES[1] | {"velocity": [0.1, 0.0], "angular_velocity": 0.0},
]
CHANNEL = {"shape": "box", "lower": [0.0, 0.0], "upper": [5.0, 4.5], "periodic": ["x"]}
BOX = {"shape": "box", "lower": [0.0, 0.0], "upper": [5.0, 4.5]}
CELL = {"shape": "cell", "vectors": VECTORS.tolist()}
DRIVEN: dict[str, tuple[dict[str, Any], list[dict[str, Any]]]] = {
    "forces in a channel": (CHANNEL, PUSHED),
    "a pressure gradient": (CHANNEL | {"pressure_gradient": 2.0}, BODIES),
    "a net flux past what is pushed": (CHANNEL | {"net_flux": 0.5, "walls": {"top": [1.0, 0.0]}}, PUSHED),
    "forces in a cell": (CELL, PUSHED),
    "forces in a sheared cell": (CELL | {"shear": 0.1}, PUSHED),
    "forces in a box": (BOX, PUSHED),
    "forces in a round container": ({"shape": "round", "radius": 5.5}, PUSHED),
}


@pytest.mark.parametrize(("domain", "bodies"), DRIVEN.values(), ids=DRIVEN)
def test_the_pressure_around_bodies_with_loads_is_that_of_the_resolved_flow(
    domain: dict[str, Any], bodies: list[dict[str, Any]]
) -> None:
    """One body is pushed and turned, the other held at a velocity, or both are free. Root mean square errors
    are 2e-3 of the pressure with four modes; without what the torque does they would be 2e-2 and more."""
    x = np.random.default_rng(4).uniform(size=(400, 2)) * [5.0, 4.5]
    found, exact = (in_cell({}, model, domain=domain, bodies=bodies) for model in ("pores", "resolved"))
    assert off(found, exact, x) < 4e-3


def test_the_pressure_around_a_disc_in_the_middle_of_a_container_is_the_exact_one() -> None:
    """psi = f sin(theta), f = A r + B / r + C r log r + D r^3, has p = mu (8 D r - 2 C / r) cos(theta); f is
    U a and f' is U at the disc, both 0 at the container. Off by 3e-3 of the largest beside the disc, 3e-4
    away from it; that of the point force alone by 3e-1."""
    a, R, U, mu = 1.0, 2.5, 1.0, 3.0
    rows = [(r, 1.0 / r, r * np.log(r), r**3) for r in (a, R)]
    slopes = [(1.0, -1.0 / r**2, np.log(r) + 1.0, 3.0 * r**2) for r in (a, R)]
    _, _, C, D = np.linalg.solve([*rows, *slopes], [U * a, 0.0, U, 0.0])
    moves = {"velocity": [U, 0.0], "angular_velocity": 0.0}
    body = {"name": "disc", "radius": a, "position": [0.0, 0.0]} | moves
    domain = {"shape": "round", "radius": R}
    solution = fsi.solve(in_cell({}, modes=12, domain=domain, bodies=[body], fluid={"viscosity": mu}))
    angle = np.linspace(0.1, 6.0, 30)
    x = np.concatenate([r * np.column_stack([np.cos(angle), np.sin(angle)]) for r in (1.01, 1.5, 2.4)])
    r = np.linalg.norm(x, axis=1)
    exact = mu * (8.0 * D - 2.0 * C / r**2) * x[:, 0]
    off = np.abs(solution.evaluate(x)[1] - exact) / np.abs(exact).max()
    assert off.max() < 6e-3
    assert off[r > 1.2].max() < 6e-4


def test_files_of_a_channel_with_a_pressure_gradient_have_it_in_one_period(tmp_path: Path) -> None:
    """Patches across its end have p less what it falls over a period; else they would be off by 10."""
    case = in_cell({}, domain=CHANNEL | {"pressure_gradient": -2.0}, time={"end": 0.1, "tolerance": 1e-2})
    run(case, tmp_path / "run")
    x = np.random.default_rng(5).uniform(size=(400, 2)) * [5.0, 4.5]
    exact, table = fsi.solve(case).evaluate(x)[1], probe(open_run(tmp_path / "run"), x, 0)
    known = (table["where"] == "fluid").to_numpy() & np.isfinite(exact)
    assert np.abs(table["p"].to_numpy() - exact)[known].max() < 1e-2 * np.nanmax(np.abs(exact))


def test_the_pressure_around_a_disc_in_a_wide_cell_is_that_in_unbounded_fluid() -> None:
    """p = -4 mu a^2 r.E r / r^4 of a disc in a strain rate E (Einstein's problem in the plane; Batchelor,
    An Introduction to Fluid Dynamics, section 4.11, has that of a sphere), less than 3 % off: the area
    fraction is 0.8 %. With mu alone, or without the square of a, it would be off by factors of 4."""
    mu, a, E = 2.0, 2.0, np.diag([0.5, -0.5])
    domain = {"shape": "cell", "vectors": [[40.0, 0.0], [0.0, 40.0]], "extension": 0.5}
    bodies = [{"name": "disc", "radius": a, "position": [1.0, 2.0]}]
    case = in_cell({}, modes=8, domain=domain, bodies=bodies, fluid={"viscosity": mu})
    solution, angle = fsi.solve(case), np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    for distance in (1.05, 1.5, 2.0):
        r = distance * a * np.column_stack([np.cos(angle), np.sin(angle)])
        p = solution.evaluate(r + np.array([1.0, 2.0]))[1]
        exact = -4.0 * mu * a**2 * np.einsum("ni,ij,nj->n", r, E, r) / np.sum(r**2, axis=1) ** 2
        assert np.abs(p - exact).max() < 0.03 * np.abs(exact).max()


def test_files_and_probes_have_the_pressure_of_the_solution(sheared: Run) -> None:
    """Interpolated in curved cells of order 6, to 1e-2 of it; the same at images far away."""
    x = points()
    exact = fsi.solve(sheared.case).evaluate(x)[1]
    for away in (np.zeros(2), 7.0 * VECTORS[0] - 5.0 * VECTORS[1]):
        table = probe(sheared, x + away, 0)
        known = (table["where"] == "fluid").to_numpy() & np.isfinite(exact)
        assert known.mean() > 0.7
        assert np.abs(table["p"].to_numpy() - exact)[known].max() < 1e-2 * np.nanmax(np.abs(exact))


def test_pictures_show_the_pressure(sheared: Run, tmp_path: Path) -> None:
    """Not those of another field."""
    pictures = [tmp_path / f"{field}.png" for field in ("pressure", "vorticity")]
    for picture in pictures:
        drawn = ("--field", picture.stem, "--size", "120", "-o", picture)
        assert fsi_command("render", sheared.path, *drawn) == 0
    assert pictures[0].read_bytes() != pictures[1].read_bytes()


def lattice(gap: float, model: str = "pores", modes: int = 4) -> Case:
    """Of one disc, stretched."""
    side = 2.0 + gap
    domain = {"shape": "cell", "vectors": [[side, 0.0], [0.0, side]]}
    return in_cell({"extension": 0.5}, model, modes, domain=domain | {"extension": 0.5}, bodies=BODIES[:1])


@pytest.mark.parametrize("gap", [1e-2, 3e-3, 1e-3])
def test_the_pressure_of_a_lattice_is_right_down_to_narrow_gaps(gap: float) -> None:
    """Off by 7e-5, 5e-4 and 1.3e-3; with 20 polynomials between feet by 9e-2 at the last. Were linear
    functions not exact around discs, by 7e-3 at the first and 4e-2 and more at the others."""
    x = (2.0 + gap) * np.random.default_rng(1).uniform(size=(600, 2))
    assert off(lattice(gap), lattice(gap, "resolved"), x) < 3e-3


def test_where_rounding_would_tell_there_is_none_and_it_is_said() -> None:
    """A gap of 4e-4 radii: pressures with 4 and 8 modes are 1e-3 apart, and off by 2e-2."""
    solution = fsi.solve(lattice(4e-4))
    assert isinstance(solution.instant, PoreInstant)
    assert narrowness(solution.instant.flow.system.pores).min() < instant.NARROWEST
    with pytest.raises(InputError, match="has a pressure only where no neck is narrow"):
        solution.evaluate([[0.0, 0.0]])


def test_where_other_modes_give_another_one_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two discs with one mode and with six they are 0.04 apart."""
    monkeypatch.setattr(instant, "APART", 0.03)
    with pytest.raises(InputError, match="has a pressure only where no neck is narrow"):
        fsi.solve(in_cell({}, modes=1, domain=CELL, bodies=PUSHED)).evaluate([[0.0, 0.0]])
    monkeypatch.setattr(instant, "APART", 0.06)
    assert np.isfinite(fsi.solve(in_cell({}, modes=1, domain=CELL, bodies=PUSHED)).evaluate([[0.0, 0.0]])[1])


@pytest.mark.parametrize("height", [0.0, 100.0])
def test_the_pressure_that_drives_a_channel_does_not_know_how_high_it_lies(height: float) -> None:
    """Off by 1.6e-3 with one mode, at any height; with the shear stress from y = 0 there was none at 100."""
    up = np.array([0.0, height])
    channel = CHANNEL | {"lower": [0.0, height], "upper": [5.0, 4.5 + height], "pressure_gradient": 1.3}
    bodies = [body | {"position": (np.array(body["position"]) + up).tolist()} for body in BODIES]
    x = up + np.random.default_rng(4).uniform(size=(400, 2)) * [5.0, 4.5]
    found, exact = (in_cell({}, model, 1, domain=channel, bodies=bodies) for model in ("pores", "resolved"))
    assert off(found, exact, x) < 5e-3


def test_mirrored_bodies_have_the_mirrored_pressure() -> None:
    """To 1e-6 of it; by 1e-4 and more where what costs nothing is not exact."""
    x = np.random.default_rng(4).uniform(size=(400, 2)) * [5.0, 4.5]
    mirrored = [
        PUSHED[0] | {"position": [3.4, 1.5], "force": [-1.0, -2.0], "torque": -0.7},
        PUSHED[1] | {"position": [1.7, 2.2], "velocity": [-0.1, 0.0]},
    ]
    one = fsi.solve(in_cell({}, domain=BOX, bodies=PUSHED)).evaluate(x)[1]
    other = fsi.solve(in_cell({}, domain=BOX, bodies=mirrored)).evaluate([5.0, 0.0] + [-1.0, 1.0] * x)[1]
    known = np.isfinite(one) & np.isfinite(other)
    assert np.abs(one - other)[known].max() < 1e-5 * np.abs(one[known]).max()


@pytest.mark.parametrize("modes", [1, 8])
def test_in_and_beside_corners_of_a_box_the_fluid_rests_at_the_pressure_there(
    modes: int, tmp_path: Path
) -> None:
    """Off by 0.9 % of the largest of the corners, in files by 0.2 %: without care weights, quotients of
    zeros, would make 1e13 of it, and files had 0."""
    case = in_cell({}, modes=modes, domain=BOX, bodies=PUSHED[:1], time={"end": 0.01, "tolerance": 1e-2})
    corners, inwards = np.array([[0.0, 0.0], [5.0, 0.0], [0.0, 4.5], [5.0, 4.5]]), np.array([2.5, 2.25])
    exact = exact_pressure(in_cell({}, "resolved", domain=BOX, bodies=PUSHED[:1]), corners)
    run(case, tmp_path / "run")
    solution, of_files = fsi.solve(case), open_run(tmp_path / "run")
    for h in (0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3):
        x = corners + h * (inwards - corners)
        u, p = solution.evaluate(x)
        assert np.abs(u).max() < 1e-4
        assert np.abs(p - exact).max() < 0.02 * np.abs(exact).max()
        assert np.abs(probe(of_files, x, 0)["p"].to_numpy() - exact).max() < 0.01 * np.abs(exact).max()


def test_inside_a_body_with_a_load_there_is_no_number() -> None:
    """At its centre, and at that of an image, a point force is infinite."""
    inside = [[1.6, 1.5], [6.6, 1.5], [1.6, 1.6]]
    u, p = fsi.solve(in_cell({}, domain=CHANNEL, bodies=PUSHED)).evaluate(inside)
    assert np.isnan(u).all()
    assert np.isnan(p).all()


def test_bodies_are_few_up_to_five_hundred() -> None:
    """As docs/pores.md says."""
    for number, few in ((500, True), (501, False)):
        flow: Any = SimpleNamespace(U=np.zeros((number, 3)))
        bodies: Any = None
        assert PoreInstant(bodies, flow, {}).few == few


def test_files_of_many_bodies_have_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It would take longer than all else: `fsi render` says which files have it, `evaluate` still does."""
    monkeypatch.setattr(instant, "FEW", 1)
    run(in_cell({"shear": 1.0}, time={"end": 0.1, "tolerance": 1e-2}), tmp_path / "run")
    many = open_run(tmp_path / "run")
    assert "pressure" not in many.mesh(0).point_data
    assert "p" not in probe(many, [[0.0, 0.0]])
    assert np.isfinite(fsi.solve(many.case).evaluate([[0.0, 0.0]])[1]).all()


@pytest.mark.filterwarnings("error")
def test_where_nothing_moves_the_pressure_is_nothing() -> None:
    held = {"velocity": [0.0, 0.0], "angular_velocity": 0.0}
    u, p = fsi.solve(in_cell({}, domain=CHANNEL, bodies=[body | held for body in BODIES])).evaluate(
        [[0.1, 0.1]]
    )
    assert_array_equal(u, [[0.0, 0.0]])
    assert_array_equal(p, [0.0])
