"""Bars hold for random walls, bodies and meshes, and are about as long as the errors; see `bench/bars.py`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fsi
from bench.bars import Kept, Value, holds, measured, values, values_of
from bench.finer import Reference, reference
from bench.random_cases import random_case
from bench.random_walls import KINDS
from fsi.bodies.configuration import Configuration, Motion
from fsi.case.load import parse_case
from fsi.meshes.errors import MeshError
from fsi.observables.bars import Compared, DrivenBodies, step_errors
from fsi.stokes.resistance import _resistance, resistance_with_error
from tests.exact_model import ExactInstant

# Data without jumps: the bar is 1.5 times an estimate that is 0.9 to 1.1 times the error.
SMOOTH = (
    "box, walls at rest", "channel, sheared", "channel, driven", "cell", "half-plane", "round container",
    "axisymmetric half-plane and ball",
)  # fmt: skip
SEED = 1000  # the bench begins at 0


@pytest.mark.parametrize("kind", SMOOTH)
def test_bars_hold_and_half_of_them_would_not(kind: str) -> None:
    """The median of error over bar is 0.68 to 0.71, the largest 0.69 to 0.74, the least 0.09 by chance."""
    ratios = [value.ratio for value in values(kind, SEED)]
    assert 0.6 < np.median(ratios) < 0.75
    assert max(ratios) <= 1.0


def unlike_discs(sizes: dict[str, Any]) -> fsi.Solution:
    """Discs of which two are thirty times smaller than the third, one of these beside it."""
    discs = {"large": (1.0, [-1.5, 0.3]), "beside": (0.03, [-0.668, 0.924]), "alone": (0.03, [0.5, -2.0])}
    data = {
        "name": "unlike", "model": "resolved", "fluid": {"viscosity": 1.0}, "discretisation": sizes,
        "domain": {"lower": [-6.0, -3.0], "upper": [6.0, 3.0], "periodic": ["x"], "walls": {"top": [1, 0]}},
        "bodies": [{"name": name, "radius": a, "position": x} for name, (a, x) in discs.items()],
    }  # fmt: skip
    return fsi.solve(parse_case(data))


def test_bars_hold_of_discs_far_smaller_than_others() -> None:
    """Against cells of degree 5. Those of a mesh for the largest were up to 3.2 bars off, and 7e-3."""
    fine = unlike_discs({"degree": 5, "cells_per_gap": 1.0}).instant.U
    coarse = {"interior": "sparse", "degree": 3, "cells_per_circle": 16}
    for sizes, most in (({}, 1e-6), ({"interior": "sparse"}, 1e-5), (coarse, 1e-4)):
        found = unlike_discs(sizes)
        assert found.errors is not None
        off = np.abs(found.instant.U - fine)
        assert np.all(off <= found.errors.U)
        assert off.max() < most


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1001, 1079, 1092])
def test_bars_of_spheres_in_coarse_cells_hold(seed: int) -> None:
    """With the bars of finer meshes, and each value known to 0.03 of the largest, up to 9 times too short."""
    assert all(value.inside for value in values("spheres in a cell", seed))


@pytest.mark.slow
def test_bars_of_quadratic_elements_beside_shapes_hold() -> None:
    """Compared with cubic ones they were up to 1.5 times too short at gaps of 1e-4; medians are 0.67."""
    cases = (("shapes, box, mixed walls", 4), ("shapes, box, walls at rest", 5))
    found = [value for kind, seed in cases for value in values(kind, seed)]
    assert all(value.inside for value in found)
    assert 0.6 < np.median([value.ratio for value in found]) < 0.75


@pytest.mark.slow
def test_bars_of_suspensions() -> None:
    """Without a part of the largest difference 14 stresslets of 1856 values were outside, by up to 15."""
    tried = measured(["suspension"], 4, SEED, Kept())
    assert not any(case.refused for case in tried)
    assert holds(values_of(tried), ["suspension"])


def test_cases_that_are_kept_are_not_solved_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    solved = []

    def value_or_refusal(kind: str, seed: int, _degree: int | None) -> list[Value]:
        solved.append(seed)
        if seed == 1:
            raise MeshError("one of them is refused")
        return [Value(kind, seed, "U[0, 1]", 0.1 * seed, np.inf)]

    monkeypatch.setattr("bench.bars.values", value_or_refusal)
    kept = Kept(tmp_path / "cases.jsonl")
    first = measured(["cell"], 2, 0, kept)
    assert measured(["cell"], 4, 0, kept)[:2] == first
    assert solved == [0, 1, 2, 3]
    assert [case.refused for case in first] == [None, "one of them is refused"]


def test_bars_hold_of_what_is_small_by_chance() -> None:
    """A velocity of 0.04 beside one of 1, one of 0.01 under a lid of 1.8: off by 2.4 and 1.2 bars before."""
    for kind, seed in (("half-plane", 7), ("cylinder", 11)):
        assert all(value.inside for value in values(kind, seed))


def test_a_velocity_is_known_to_a_part_of_what_loads_miss() -> None:
    """Held at speed 2 under a load 4 that misses 0.4, a tenth: 0.03 of a tenth of 2 are 0.006."""
    case = random_case("half-plane", 7)
    held, none = np.array([[True, False, True]]), np.zeros((1, 3))
    q, U = Configuration.unturned(np.array([[0.0, 3.0]]), np.ones(1)), np.array([[2.0, 0.1, 0.0]])
    missed = np.array([[0.4, 0.0, 0.0]])
    computed, other = (ExactInstant(U, np.array([[4.0, 0.0, 0.0]]) + off) for off in (0.0, missed))
    bodies = DrivenBodies(case, q, 0.0, Motion(held, none, none))
    errors = step_errors(bodies, computed, Compared(other, 1.0)).errors
    assert errors.U[0, 1] == pytest.approx(0.03 * 0.1 * 2.0)
    assert errors.F[0] == pytest.approx([0.4, 0.0, 0.03 * 0.1 * 4.0])


def test_velocities_that_are_small_by_chance_may_be_known_less_than_loads() -> None:
    """As above, to 0.2 and to 0.05: 0.2 of a tenth of 2, 0.05 of a tenth of 4."""
    case = random_case("half-plane", 7)
    held, none = np.array([[True, False, True]]), np.zeros((1, 3))
    q, U = Configuration.unturned(np.array([[0.0, 3.0]]), np.ones(1)), np.array([[2.0, 0.1, 0.0]])
    computed, other = (ExactInstant(U, np.array([[load, 0.0, 0.0]])) for load in (4.0, 4.4))
    bodies = DrivenBodies(case, q, 0.0, Motion(held, none, none))
    errors = step_errors(bodies, computed, Compared(other, 1.0, 0.05, chance_of_free=0.2)).errors
    assert errors.U[0, 1] == pytest.approx(0.2 * 0.1 * 2.0)
    assert errors.F[0] == pytest.approx([0.4, 0.0, 0.05 * 0.1 * 4.0])


def test_a_bar_is_no_shorter_than_what_rounding_makes_of_a_gap() -> None:
    """1e-6 at a distance of 300 from the origin is known to eps 301 / 1e-6, and a force to 2.5 times this."""
    data = {
        "name": "t",
        "fluid": {"viscosity": 1.0},
        "domain": {"lower": [300.0, -4.0], "upper": [309.0, 4.0]},
    }
    body = {"name": "disc", "radius": 1.0, "position": [301.000001, 2.0], "velocity": [1.0, 0.0]}
    case = parse_case(data | {"bodies": [body]})
    same = ExactInstant(np.array([[1.0, 0.0, 0.0]]), np.array([[4.0, 0.0, 0.0]]))
    bodies = DrivenBodies(case, case.configuration(), 0.0, case.motion(0.0))
    errors = step_errors(bodies, same, Compared(same, 1.0)).errors
    assert errors.F[0, 0] == pytest.approx(4.0 * 2.5 * 2.22e-16 * 301.0 / 1e-6, rel=1e-2)


@pytest.mark.slow
def test_bars_in_space_hold() -> None:
    """Two with sliding lids had bars 2.3 and 4.1 times too small with one mesh for all flows.

    One by a plane had one 1.9 times too small for what its elements of degree 2 missed less by chance.
    """
    lids = "space, sliding lids"
    seeds = (("space", 1), ("space", 2), (lids, 10), (lids, 28))
    found = [value for kind, seed in seeds for value in values(kind, seed)]
    flow = [value for value in found if value.name != "dissipation"]
    assert flow
    assert all(value.inside for value in flow)


@pytest.mark.slow
def test_velocities_in_space_that_symmetry_makes_zero_are_within_their_bars() -> None:
    """A sphere in a driven channel moves along x only and turns about y; along y it was off by 1.74 bars."""
    data = {
        "name": "one", "geometry": "spatial", "fluid": {"viscosity": 1.0},
        "domain": {
            "lower": [0.0] * 3, "upper": [16.0, 16.0, 12.0], "periodic": ["x", "y"],
            "pressure_gradient": -1.0,
        },
        "bodies": [{"name": "s", "radius": 0.5, "position": [3.0, 2.0, 4.0]}],
    }  # fmt: skip
    found = fsi.solve(parse_case(data))
    assert found.errors is not None
    zero = [1, 2, 3, 5]
    assert np.all(np.abs(found.instant.U[0, zero]) <= found.errors.U[0, zero])
    assert np.all(found.errors.U[0, :3] < 5e-6 * found.instant.U[0, 0])


@pytest.mark.slow
def test_the_finer_solve_has_converged(monkeypatch: pytest.MonkeyPatch) -> None:
    """Between open and solid walls: 6 halvings fewer change it by 5e-8 at most, none at all by 2e-4."""
    case = random_case("box, open walls", 1)
    fine = reference(case)
    monkeypatch.setattr("bench.finer.HALVINGS", 14)
    np.testing.assert_allclose(fine.U, reference(case).U, rtol=0.0, atol=1e-7)


@pytest.mark.slow
def test_bars_of_many_cases() -> None:
    """In the plane and on an axis; docs/accuracy.md has 300 cases of spheres, whose bars take hours to try.

    Three cells of spheres would not tell: stresses of one, seed 1001, are beyond their bars together.
    """
    kinds = [kind for kind in KINDS if not kind.startswith(("space", "suspension", "spheres"))]
    tried = measured(kinds, 3 * len(kinds), SEED, Kept())
    assert sum(case.refused is not None for case in tried) <= len(kinds) // 4
    assert holds(values_of(tried), kinds)


@pytest.mark.parametrize(
    "kind",
    ["box, walls at rest", pytest.param("half-plane", marks=pytest.mark.slow), "cylinder", "round container"],
)
def test_bars_of_resistances_of_several_bodies_hold(kind: str) -> None:
    """Every entry of R and of the mobility, against elements of degree 5 on a mesh twice as fine."""
    case = random_case(kind, SEED)
    assert len(case.bodies) > 1
    solved, finer = resistance_with_error(case), Reference(case)
    exact = _resistance(case, finer.units, finer.meshes.scaled_mesh, 5)
    entries, errors = solved.resistance, solved.errors
    assert entries.mobility is not None
    assert exact.mobility is not None
    assert errors.mobility is not None
    of_mobility = (entries.mobility - exact.mobility) / errors.mobility
    ratios = np.abs(np.stack([(entries.R - exact.R) / errors.R, of_mobility]))
    assert 0.5 < ratios.max() <= 1.0
