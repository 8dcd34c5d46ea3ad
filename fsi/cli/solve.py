"""`fsi solve`: one instant."""

from __future__ import annotations

import json

import typer
from rich.console import Console

from fsi import parallel
from fsi.cli.arguments import AsJson, CaseFile, Overrides, load_resolved

EXAMPLE = "Example: fsi solve cases/disc_in_box.toml --set discretisation.cells_per_gap=2 --json"


def solve(
    case_file: CaseFile,
    as_json: AsJson = False,
    overrides: Overrides = None,
) -> None:
    """Solve a case at time 0: velocities, forces of the fluid on the bodies with their errors, checks.

    The errors bound what the mesh and the elements do, estimated with one degree more. A case with
    discretisation.tolerance is refined until the largest, relative, is below it.

    A half-plane or a round container may stand for an infinite one: the solve is repeated with half its
    radius. The change of the results is the reported truncation, and the error at the full radius is less.
    """
    from fsi.report import print_solution, solution_json
    from fsi.stokes.model import StokesModel
    from fsi.stokes.refine import solve_with_errors
    from fsi.truncation import halved, truncation

    solved = solve_with_errors(load_resolved(case_file, overrides, "solve"))
    case, solution, errors = solved.case, solved.solution, solved.errors
    half = halved(case)
    truncated = None
    if half is not None:
        truncated = truncation(case, solution, StokesModel(half)(half.configuration(), 0.0))
    if parallel.is_root() and as_json:
        typer.echo(json.dumps(solution_json(case, solution, errors, truncated)))
    elif parallel.is_root():
        print_solution(Console(), case, solution, errors, truncated)
