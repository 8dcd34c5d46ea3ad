"""What `fsi solve` prints, for a solution made by hand."""

import io
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from fsi.arrays import Array
from fsi.bodies.gaps import foot_between
from fsi.case.case import Case
from fsi.case.load import load_case, parse_case
from fsi.integration.errors import ErrorEstimate
from fsi.observables.solved_flow import SolvedFlow
from fsi.observables.truncation import halved, truncation
from fsi.report.case import print_case
from fsi.report.console import standard_output
from fsi.report.gaps import gaps_json
from fsi.report.solution import print_solution, solution_json

CASES = Path(__file__).parents[2] / "cases"


def solved(U: Array, F: Array, iterations: int = 0) -> SolvedFlow:
    """Some numbers in place of a flow."""
    seconds = {"mesh": 0.25, "solve": 0.5}
    return SolvedFlow(U, F, F + 1.0, 7.0, {"power": 1e-13}, 120, 30, iterations, seconds, None, ())


ERRORS = ErrorEstimate(U=np.array([[0.0, 0.0, 2e-7]]), F=np.array([[1e-6, 3e-3, 0.0]]), dissipation=0.03)


@pytest.fixture
def case() -> Case:
    return load_case(
        CASES / "disc_beside_plane.toml", ["bodies.0.angular_velocity=free", "bodies.0.radius=0.5"]
    )


def test_the_force_is_that_of_the_fluid_on_the_body(case: Case) -> None:
    solution = solved(U=np.array([[0.0, -1.0, 0.5]]), F=np.array([[0.0, -466.0, 0.0]]))
    found = json.loads(json.dumps(solution_json(case, solution, ERRORS, {"force": 1e-6})))
    assert found == {
        "name": "disc beside a plane",
        "bodies": [
            {
                "name": "disc",
                "position": [0.0, 1.1],
                "velocity": [0.0, -1.0],
                "angular_velocity": 0.5,
                "force": [0.0, 466.0],
                "torque": 0.0,
                "velocity_error": [0.0, 0.0],
                "angular_velocity_error": 2e-7,
                "force_error": [1e-6, 3e-3],
                "torque_error": 0.0,
            }
        ],
        "dissipation": 7.0,
        "dissipation_error": 0.03,
        "checks": {"power": 1e-13},
        "discretisation": {
            "degree": 4,
            "cells_per_gap": 0.45,
            "cells_per_circle": 32,
            "growth": 0.33,
            "interior": "graded",
            "formulation": "eliminated",
            "solver": "automatic",
        },
        "dofs": 120,
        "cells": 30,
        "solver": "direct solver",
        "seconds": 0.75,
        "seconds_by_phase": {"mesh": 0.25, "solve": 0.5},
        "truncation": {"force": 1e-6},
    }


def test_the_table_shows_reaction_traction_and_checks(case: Case) -> None:
    console = Console(width=110, record=True, quiet=True)
    solution = solved(U=np.array([[0.0, -1.0, 0.5]]), F=np.array([[0.0, -466.0, 0.0]]))
    with console.capture() as printed:
        console.quiet = False
        print_solution(console, case, solution, ERRORS, {"force": 2e-6})
    text = printed.get()
    assert all(
        word in text
        for word in ("466", "465", "power", "1.0e-13", "truncation", "2.0e-06", "120 unknowns", "3e-03")
    )


def test_what_friction_of_slip_takes_is_told_where_fluid_slides(case: Case) -> None:
    stuck = solved(U=np.array([[0.0, -1.0, 0.5]]), F=np.array([[0.0, -466.0, 0.0]]))
    sliding = replace(stuck, slip_dissipation=0.25)
    assert "slip_dissipation" not in solution_json(case, stuck, ERRORS, None)
    assert solution_json(case, sliding, ERRORS, None)["slip_dissipation"] == 0.25
    told = []
    for solution in (stuck, sliding):
        printed = io.StringIO()
        print_solution(Console(file=printed, width=300), case, solution, ERRORS, None)
        told.append(printed.getvalue())
    assert "; dissipation 7 ± 3e-02; " in told[0]
    assert "; dissipation 7 ± 3e-02 in the fluid, 0.25 by friction on what it slides along; " in told[1]


def test_an_infinite_dissipation_is_said_in_place_of_digits(case: Case) -> None:
    finite = solved(U=np.array([[0.0, -1.0, 0.5]]), F=np.array([[0.0, -466.0, 0.0]]))
    solution = replace(finite, dissipation=np.inf, jumps=(("left", "top"), ("right", "top")))
    errors = replace(ERRORS, dissipation=np.nan)
    why = "the velocity jumps where walls meet: left and top, right and top"
    data = json.loads(json.dumps(solution_json(case, solution, errors, None), allow_nan=False))
    assert data["dissipation"] is data["dissipation_error"] is None
    assert data["dissipation_infinite"] == why
    console = Console(width=200, quiet=True)
    with console.capture() as printed:
        console.quiet = False
        print_solution(console, case, solution, errors, None)
        print_solution(console, case, finite, ERRORS, None)
    assert f"dissipation infinite ({why});" in printed.get()
    assert "dissipation 7 ± 3e-02;" in printed.get()


def test_truncation_compares_results_only_with_torques_over_the_radius(case: Case) -> None:
    # held: V_x, V_y; free: omega. The load on the free rotation and the held velocity are no results.
    whole = solved(U=np.array([[0.0, -1.0, 0.2]]), F=np.array([[1.0, -4.0, 9.0]]))
    half = solved(U=np.array([[0.0, -1.0, 0.3]]), F=np.array([[1.0, -5.0, 0.0]]))
    found = truncation(case, whole, half)
    assert found == {"force": pytest.approx(1.0 / 4.0), "velocity": pytest.approx(0.5)}


def test_truncation_leaves_out_what_is_zero(case: Case) -> None:
    whole = solved(U=np.array([[0.0, -1.0, 0.0]]), F=np.array([[0.0, -4.0, 0.0]]))
    assert truncation(case, whole, whole) == {"force": 0.0}


def test_only_a_half_disc_that_still_holds_the_bodies_is_halved(case: Case) -> None:
    smaller = halved(case)
    assert smaller is not None
    assert smaller.container().size() == case.container().size() / 2.0
    assert smaller.bodies == case.bodies
    assert halved(load_case(CASES / "disc_in_box.toml")) is None
    assert halved(load_case(CASES / "disc_beside_plane.toml", ["domain.radius=4.0"])) is None


def test_no_number_is_cut_where_there_is_no_terminal(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """At 80 columns rich ends the columns of a wide table with an ellipsis, its verdict too."""
    monkeypatch.delenv("COLUMNS", raising=False)
    standard_output().print("-" * 130)
    assert capsys.readouterr().out == "-" * 130 + "\n"


def test_a_lone_body_of_a_periodic_cell_is_nearest_to_its_own_image() -> None:
    """Images 5 away on one side and 7 on the other, a radius of 1: the gap is 3."""
    domain = {"shape": "cell", "vectors": [[5.0, 0.0], [0.0, 7.0]], "shear": 1.0}
    body = {"name": "disc", "radius": 1.0, "position": [1.0, 1.0]}
    data = {"name": "lone", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": [body]}
    printed = standard_output_of(parse_case(data))
    rows = [line.replace("│", " ").split() for line in printed.splitlines()]
    assert ["disc", "1,", "1", "1", "3", "disc", "free", "free", "free"] in rows


def test_all_gaps_of_shapes_are_listed() -> None:
    """A rod, its ends 1.25 from its centre, 0.1 off it in a circle of radius 2."""
    sizes = {"name": "x", "fluid": {"viscosity": 1.0}}
    rod = {"name": "rod", "shape": {"kind": "stadium", "length": 2.0, "radius": 0.25}, "position": [0.1, 0.0]}
    case = parse_case(sizes | {"domain": {"shape": "round", "radius": 2.0}, "bodies": [rod]})
    shown = gaps_json(case)
    assert [gap["between"] for gap in shown] == [["rod", "far"]] * 2
    assert [gap["gap"] for gap in shown] == pytest.approx([0.65, 0.85], rel=1e-12)
    assert shown[0]["at"] == pytest.approx([1.675, 0.0], abs=1e-9)
    listed = standard_output_of(case)
    assert "0.65" in listed
    assert "0.85" in listed


def test_a_shape_far_from_all_has_no_table_of_gaps() -> None:
    """Its gaps, of more than its radius, are not listed: a table without rows would be left."""
    shape = {"kind": "ellipse", "axes": [0.4, 0.2]}
    domain = {"shape": "round", "radius": 2.0}
    body = {"name": "rod", "shape": shape, "position": [0.0, 0.0]}
    data = {"name": "x", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": [body]}
    assert "gap between" not in standard_output_of(parse_case(data))


def test_the_nearest_of_two_shapes_far_from_each_other() -> None:
    """Ends 5 - 1 on both sides of the middle are 8 apart, more than both are long; the wall is 14 off."""
    shape, domain = {"kind": "ellipse", "axes": [1.0, 0.7]}, {"shape": "round", "radius": 20.0}
    bodies = [{"name": name, "shape": shape, "position": [x, 0.0]} for name, x in (("a", -5.0), ("b", 5.0))]
    data = {"name": "x", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": bodies}
    rows = [line.replace("│", " ").split() for line in standard_output_of(parse_case(data)).splitlines()]
    assert ["a", "-5,", "0", "1", "8", "b", "free", "free", "free"] in rows
    assert ["b", "5,", "0", "1", "8", "a", "free", "free", "free"] in rows


def test_each_gap_of_shapes_is_looked_for_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of sixteen ellipses, 3 apart in a square, 32 pairs are near; the list of gaps looks for them again.

    For each body anew there were all pairs that are no farther apart than the cell is large.
    """
    followed = []

    def counted(q: Any, i: int, j: int, away: Any = 0.0) -> Any:
        followed.append((i, j))
        return foot_between(q, i, j, away)

    cell = {"shape": "cell", "vectors": [[12.0, 0.0], [0.0, 12.0]], "shear": 1.0}
    shape = {"kind": "ellipse", "axes": [1.0, 0.7]}
    places = [[3.0 * k, 3.0 * m] for k in range(4) for m in range(4)]
    bodies = [{"name": f"e{k}", "shape": shape, "position": x} for k, x in enumerate(places)]
    case = parse_case({"name": "x", "fluid": {"viscosity": 1.0}, "domain": cell, "bodies": bodies})
    monkeypatch.setattr("fsi.bodies.gaps.foot_between", counted)
    standard_output_of(case)
    assert 32 <= len(followed) <= 64


def standard_output_of(case: Case) -> str:
    """What `fsi check` prints of it."""
    printed = io.StringIO()
    print_case(Console(file=printed, width=140), case)
    return printed.getvalue()
