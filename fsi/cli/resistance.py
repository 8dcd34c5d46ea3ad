"""`fsi resistance`: the resistance matrix and its inverse."""

import json
from pathlib import Path
from typing import Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import AsJson, CaseFile, Overrides, load_resolved, output_to, require_writable
from fsi.errors import InputError
from fsi.report.console import standard_output

EXAMPLE = "Example: fsi resistance cases/two_discs.toml -o two_discs.npz"


def resistance(
    case_file: CaseFile,
    output: Annotated[
        Path | None, output_to("A .json or .npz file for R and its inverse, .csv for R.", False)
    ] = None,
    as_json: AsJson = False,
    overrides: Overrides = None,
) -> None:
    """Compute the resistance matrix R of all bodies, F = R U, and its inverse, the mobility.

    F are the external loads that unit motions of the bodies need at time 0 between walls at rest, or open
    where the case has them open; its velocities of walls, its motions and loads of bodies are ignored. The
    error of R, over the diagonal, is estimated with another degree and held to discretisation.tolerance.
    In a container of given radius the change of R with half that radius is reported, as by fsi solve.
    """
    from fsi.observables.resistance import difference
    from fsi.observables.truncation import halved
    from fsi.report.resistance import print_resistance, require_format, resistance_json, write_resistance

    if output is not None:
        require_writable(output)
        require_format(output)
    case = load_resolved(case_file, overrides, "resistance")
    if not case.bodies:
        raise InputError("bodies: there are none; a resistance matrix needs at least one [[bodies]]")
    from fsi.stokes.resistance import case_resistance, resistance_with_error

    solved = resistance_with_error(case)
    found, half = solved.resistance, halved(solved.case)
    truncation = None if half is None else difference(found.R, case_resistance(half).R, found.modes.scale)
    data = resistance_json(case.name, found, solved.error, truncation)
    if output is not None:
        parallel.on_root(lambda: write_resistance(output, data))
    if parallel.is_root() and as_json:
        typer.echo(json.dumps(data))
    elif parallel.is_root():
        print_resistance(standard_output(), case.name, found, solved.error, truncation)
