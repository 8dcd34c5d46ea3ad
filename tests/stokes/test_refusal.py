"""Messages of refused solves and meshes name key, value and remedies, which work where they are taken."""

import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import fsi.meshes.build
from bench.gaps import CASES
from bench.random_cases import random_case
from fsi.calibration.finding import pair_of
from fsi.calibration.sampling import resolved_sample
from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.case.sections import Lubrication
from fsi.errors import RefusedError, SolveError, apart
from fsi.meshes.cells.curved import WORST_ACCEPTED
from fsi.meshes.errors import MeshError
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.resolution import Resolution
from fsi.report.console import standard_output
from fsi.report.solution import print_solution
from fsi.stokes.adapt import Refinement, _missed, solve_with_errors
from fsi.stokes.meshes import CaseMeshes
from fsi.stokes.model import StokesModel
from fsi.stokes.refusal import explained
from fsi.stokes.resistance import case_resistance
from tests.commands import fsi_command
from tests.flows import BOX, disc_over_plane
from tests.small_run import rows


def in_corner(x: float, y: float = 0.0, gap: float = 1e-7) -> Case:
    """A disc in the lower left corner, at (x, y), of a box."""
    places = [f"bodies.0.position=[{x + 1.0 + gap!r}, {y + 1.0 + gap!r}]"]
    walls = [f"domain.lower=[{x!r}, {y!r}]", f"domain.upper=[{x + 16.0!r}, {y + 16.0!r}]"]
    return load_case(CASES / "disc_in_box.toml", [*places, *walls])


def solved(case: Case) -> object:
    return StokesModel(case)(case.configuration(), 0.0)


ROUND = {"shape": "round", "radius": 3.0, "walls": {"far": [1.0, 0.3]}}
GAP = r"; bodies: the narrowest gap, between 'disc' and '(left|bottom)', is 1e-07; widen it"
ORIGIN = re.compile(GAP + r", or shift all coordinates so that the origin is there, at \((\S+), (\S+)\)$")


def test_a_refused_solve_names_the_gap_and_remedies_that_work() -> None:
    """Far from the origin rounding is a part of the gap; widened, or with the origin there, it goes.

    Such a flow is solved, with a bar that holds the rounding: this is said of it if it were not.
    """
    case = in_corner(-800.0)
    problem = StokesModel(case)(case.configuration(), 0.0).problem
    with pytest.raises(SolveError) as refused, explained(problem, case.names, np.zeros(2)):
        raise RefusedError("no")
    found = ORIGIN.search(str(refused.value))
    assert found is not None
    solved(in_corner(-800.0, gap=1e-3))
    solved(in_corner(-800.0 - float(found[2]), -float(found[3])))


def test_the_origin_of_a_round_container_cannot_be_shifted() -> None:
    """Its middle is there: the gap of a disc away from it is named, and no place for the origin."""
    body = {"name": "disc", "radius": 1.0, "position": [1.99, 0.0]}
    case = parse_case({"name": "t", "fluid": {"viscosity": 1.0}, "domain": ROUND, "bodies": [body]})
    problem = StokesModel(case)(case.configuration(), 0.0).problem
    remedy = r"^no; bodies: .* 'disc' and 'far', is 0\.01; widen it$"
    with pytest.raises(SolveError, match=remedy), explained(problem, case.names, np.zeros(2)):
        raise RefusedError("no")


@pytest.mark.parametrize(
    ("corner", "origin", "remedy"),
    [
        ((30.0, 20.0), (0.0, 0.0), r"shift all coordinates so that the origin is there, at \(30, 20\)$"),
        ((30.0, 20.0), (30.0, 20.0), r"widen it$"),
        ((0.0, 0.0), (0.0, 0.0), r"widen it$"),
    ],
)
def test_the_origin_is_wanted_in_the_corner_that_shuts_fluid_in(
    corner: tuple[float, float], origin: tuple[float, float], remedy: str
) -> None:
    """Not at the point of a wall beside the disc, here (30, 21); and not again where it is."""
    case = in_corner(*corner, gap=4e-6)
    problem = cast(Any, SimpleNamespace(q=case.configuration(), container=case.container()))
    with pytest.raises(SolveError, match=remedy), explained(problem, case.names, np.array(origin)):
        raise RefusedError("no")


def test_a_refused_resistance_names_the_gap_and_a_remedy_that_works(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without extended precision its asymmetry is 5e-7 at a gap of 2e-8, 500 times what is allowed."""
    monkeypatch.setattr("fsi.stokes.solvers.elimination.NARROW", 0.0)
    with pytest.raises(SolveError, match=f"{GAP.replace('1e-07', '2e-08')}$"):
        case_resistance(in_corner(-800.0, gap=2e-8))
    case_resistance(in_corner(-800.0, gap=1e-3))


SIZES = ("cells_per_circle=8", "cells_per_gap=0.3")


@pytest.mark.parametrize(
    ("gap", "remedy"), [(0.5, "raise discretisation.cells_per_circle"), (1e-3, "widen it")]
)
def test_a_wide_gap_is_not_to_blame(gap: float, remedy: str) -> None:
    q = disc_over_plane(gap)
    problem = cast(Any, SimpleNamespace(q=q, container=BOX))
    with pytest.raises(SolveError, match=remedy), explained(problem, ["disc"]):
        raise RefusedError("a defect")


def coarse(gap: float, growth: float = 1.0) -> Case:
    """A sphere whose coarse cells turn over when they are curved."""
    changes = [f"discretisation.{size}" for size in (*SIZES, f"growth={growth}")]
    return load_case(CASES / "sphere_towards_plane.toml", [*changes, f"bodies.0.position=[0.0, {1.0 + gap}]"])


@pytest.mark.parametrize("gap", [2.0, 3.0])
def test_a_mesh_that_is_refused_is_made_again(gap: float, capsys: pytest.CaptureFixture[str]) -> None:
    """With half the growth, and the report says so in a line; where it is not refused nothing is said."""
    case = coarse(gap)
    found = solve_with_errors(case)
    print_solution(standard_output(), found.case, found.solution, found.errors, None)
    said = "the sizes of the case gave no valid mesh; taken: discretisation.growth = 0.5"
    assert said in capsys.readouterr().out
    assert CaseMeshes(coarse(gap, 0.5)).scaled_mesh(case.configuration()).instead == ""


def test_a_coarse_mesh_around_a_lone_sphere_is_made_until_it_is_valid() -> None:
    """Six elements around it, of order 3: 8, 10 and 12 turn over too, with finer gaps or without."""
    case = random_case("space", 8)
    found = CaseMeshes(case).scaled_mesh(case.configuration(), order=3)
    assert found.instead == "discretisation.cells_per_circle = 15"
    assert found.quality > WORST_ACCEPTED


def test_a_mesh_that_is_made_again_is_said_of_resistances_runs_and_samples(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line at the end of each, and a column; nothing where the sizes of the case did."""
    keys = [key for size in SIZES for key in ("--set", f"discretisation.{size}")]
    case = [CASES / "sphere_towards_plane.toml", *keys, "--set", "bodies.0.position=[0.0, 3.0]"]
    time = ["--set", "time.end=1e-6", "--set", "output.fields=false"]
    for growth, instead in ((1.0, True), (0.5, False)):
        grown, folder = [*case, "--set", f"discretisation.growth={growth}"], tmp_path / f"{growth}"
        assert fsi_command("resistance", *grown) == 0
        assert (
            "gave no valid mesh; taken: discretisation.growth = 0.5" in capsys.readouterr().out
        ) == instead
        assert fsi_command("run", *grown, *time, "--output", folder) == 0
        said = (
            "note: from t = 0 the sizes of the case gave some steps no valid mesh, and they took finer ones;"
        )
        assert (f"{said} see mesh_instead in steps.csv" in capsys.readouterr().out) == instead
        assert {row["mesh_instead"] for row in rows(folder / "steps.csv")} == {str(int(instead))}
        sizes = [f"discretisation.{size}" for size in (*SIZES, f"growth={growth}")]
        pair = pair_of(
            load_case(CASES / "calibration" / "sphere_wall.toml", [*sizes, "domain.radius=1000.0"])
        )
        assert resolved_sample(pair, 2.0, held_out=False).mesh_instead == instead


@pytest.mark.parametrize("gap", [2.0, 3.0])
def test_the_remedy_of_a_refused_mesh_works(gap: float, monkeypatch: pytest.MonkeyPatch) -> None:
    case = coarse(gap)
    monkeypatch.setattr(fsi.meshes.build, "SLOWER", (1.0,))
    with pytest.raises(MeshError, match=r"lower discretisation\.growth or raise cells_per_circle") as refused:
        CaseMeshes(case).scaled_mesh(case.configuration())
    assert "; discretisation.growth = 1 did not help either" in str(refused.value)
    CaseMeshes(coarse(gap, 0.5)).scaled_mesh(case.configuration())


def test_what_touches_is_not_meshed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    tries: list[float] = []
    make: Callable[..., object] = fsi.meshes.build._triangles

    def counted(domain: FluidDomain, resolution: Resolution) -> object:
        tries.append(resolution.growth)
        return make(domain, resolution)

    monkeypatch.setattr(fsi.meshes.build, "_triangles", counted)
    case = coarse(1.0)
    q = case.configuration()
    q.centres[0, 1] = 0.5
    with pytest.raises(MeshError, match="touches") as refused:
        CaseMeshes(case).scaled_mesh(q)
    assert "did not help" not in str(refused.value)
    assert tries == [1.0]


@pytest.mark.parametrize(
    ("value", "bound", "text"),
    [
        (1.04e-9, 1e-9, "1.04e-09"), (2e-9, 1e-9, "2e-09"), (float("nan"), 1e-9, "nan"),
        (1.74e-9, 1.72e-9, "1.74e-09"),  # two digits, 1.7, would be below the bound
    ],
)  # fmt: skip
def test_a_value_beyond_a_bound_never_looks_like_it(value: float, bound: float, text: str) -> None:
    assert apart(value, bound) == text
    assert float(apart(bound * (1.0 + 1e-12), bound)) > bound


def test_a_tolerance_that_is_just_missed_says_by_how_much() -> None:
    """Of the case, where a run needs half of it too; the error has as many digits as put it above."""
    case = load_case(
        CASES / "disc_in_box.toml", ["discretisation.degree=2", "discretisation.tolerance=1.4e-4"]
    )
    said = str(_missed(Refinement(case, 1.404e-4, 900), 1.4e-4))
    assert "tolerance = 0.00014: the estimated error came down to 0.0001404, with cells_per_gap = 1, " in said
    assert said.endswith("; raise it, or degree above 2")
    with_laws = case.model_copy(update={"lubrication": Lubrication(below=0.01)})
    assert str(_missed(Refinement(with_laws, 1.404e-4, 900), 1.4e-4)).endswith(
        "; raise it, or degree above 2, or lower lubrication.below = 0.01: a part is of its laws"
    )
    in_run = str(_missed(Refinement(case, 1e-4, 900), 0.7e-4))
    assert "tolerance = 0.00014: the" in in_run
    assert "came down to 0.0001, not to the 7e-05 that the steps to come need, with" in in_run


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (-10, "a singular matrix: is a body or the flow left without anything that holds it? hold a body"),
        (-13, "most likely too little memory: lower discretisation.cells_per_circle or degree, raise growth"),
    ],
)
def test_what_mumps_refuses_is_said_in_words(
    status: int, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fsi.stokes.solvers.mumps._factorise", lambda _: status)
    with pytest.raises(SolveError, match=re.escape(f"INFOG(1) = {status}, {words}")):
        solved(coarse(1.0, 0.5))
