"""`fsi solve`: one instant."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import AsJson, CaseFile, Overrides, load
from fsi.report.console import standard_output

if TYPE_CHECKING:
    from fsi.case.case import Case

EXAMPLE = "Example: fsi solve cases/disc_in_box.toml --set discretisation.cells_per_gap=2 --json"


def solve(
    case_file: CaseFile,
    as_json: AsJson = False,
    overrides: Overrides = None,
) -> None:
    """Solve a case at time 0: velocities, forces of the fluid on the bodies with their errors, checks.

    The errors bound what the mesh and the elements do, estimated with one degree more. A case with
    discretisation.tolerance is refined until the largest, relative, is below it. Masses play no part: free
    bodies have the velocity that their loads give them, where fsi run starts heavy ones from rest.

    A half-plane or a round container may stand for an infinite one: the solve is repeated with half its
    radius. The change of the results is the reported truncation, and the error at the full radius is less.

    Of a case with model = "reduced" the velocities, without inertia, and the forces in its gaps are shown.
    """
    case = load(case_file, overrides)
    if case.model == "reduced":
        _solve_reduced(case, as_json=as_json)
        return
    from fsi.observables.truncation import halved, truncation
    from fsi.report.solution import print_solution, solution_json
    from fsi.stokes.adapt import solve_with_errors
    from fsi.stokes.model import StokesModel

    solved = solve_with_errors(case)
    case, solution, errors = solved.case, solved.solution, solved.errors
    half = halved(case)
    truncated = None
    if half is not None:
        truncated = truncation(case, solution, StokesModel(half)(half.configuration(), 0.0))
    if parallel.is_root() and as_json:
        typer.echo(json.dumps(solution_json(case, solution, errors, truncated)))
    elif parallel.is_root():
        print_solution(standard_output(), case, solution, errors, truncated)


def _solve_reduced(case: Case, *, as_json: bool) -> None:
    """Without inertia, as the resolved model is solved."""
    from fsi.reduced.model import ReducedModel
    from fsi.report.solution import instant_json, print_instant

    found = ReducedModel(case)(case.configuration(), 0.0)
    if parallel.is_root() and as_json:
        typer.echo(json.dumps(instant_json(case, found)))
    elif parallel.is_root():
        print_instant(standard_output(), case, found)
