"""`fsi solve`, `fsi resistance`, `fsi mesh`: one instant, the resistance matrix, the mesh."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import (
    AsJson,
    CaseFile,
    Overrides,
    load,
    load_meshed,
    load_with_flow,
    option,
    output_to,
    require_writable,
    tell,
)
from fsi.cli.loading import loading
from fsi.errors import InputError
from fsi.files import json_text
from fsi.report.console import standard_output

if TYPE_CHECKING:
    from collections.abc import Callable

    from fsi.case.case import Case
    from fsi.case.drag_file import DragFile
    from fsi.observables.resistance import Resistance, ResistanceErrors

EXAMPLE = "Example: fsi solve cases/disc_in_box.toml --set discretisation.cells_per_gap=2 --json"
RESISTANCE_EXAMPLE = "Example: fsi resistance cases/two_discs.toml -o two_discs.npz"
MESH_EXAMPLE = "Example: fsi mesh cases/disc_in_box.toml -o disc.vtu, or fsi mesh RUN --step 7 -o 7.msh"


def solve(
    case_file: CaseFile,
    as_json: AsJson = False,
    overrides: Overrides = None,
) -> None:
    """Solve a case at time 0: velocities, forces of the fluid on the bodies with their errors, checks.

    The errors bound what the mesh and the elements do, estimated with another degree. A case with
    discretisation.tolerance is refined until the largest, relative, is below it. Masses play no part: free
    bodies have the velocity that their loads give them, where fsi run starts heavy ones from rest.

    A half-plane or a round container may stand for an infinite one: the solve is repeated with half its
    radius. The change of the results is the reported truncation; the error at the full radius is about as
    large or less, but for bodies with a net force in a round container of the plane: what they do depends on
    log R for ever.

    With model = "pores" the errors are from more modes an edge, the apparent viscosity is an upper bound, and
    the necks are listed in which most is dissipated. With model = "reduced" the velocities, without inertia,
    and the forces in its gaps are shown.
    """
    case = load(case_file, overrides)
    if not case.level.flow:
        _solve_without_flow(case, as_json=as_json)
        return
    with loading():
        from fsi.models import flow_solvers, make_model
        from fsi.observables.truncation import halved, truncation
        from fsi.report import pores, solution

        solver = flow_solvers(case)
    solved = solver.solve(case)
    case, found, half = solved.case, solved.solution, halved(solved.case)
    truncated = None
    if half is not None:
        truncated = truncation(case, found, make_model(half)(half.configuration(), 0.0))
    if not parallel.is_root():
        return
    show = {"resolved": solution, "pores": pores}[case.model]
    if as_json:
        typer.echo(json_text(show.solution_json(case, found, solved.errors, truncated)))
    else:
        show.print_solution(standard_output(), case, found, solved.errors, truncated)


def _solve_without_flow(case: Case, *, as_json: bool) -> None:
    """Without inertia, as the resolved model is solved. Raises InputError: its level has no instant."""
    from fsi.models import make_model
    from fsi.report.network import instant_json, print_instant

    found = make_model(case)(case.configuration(), 0.0)
    if parallel.is_root() and as_json:
        typer.echo(json_text(instant_json(case, found)))
    elif parallel.is_root():
        print_instant(standard_output(), case, found)


def resistance(
    case_file: CaseFile,
    output: Annotated[
        Path | None, output_to("A .json or .npz file for R, its inverse and their errors, .csv for R.", False)
    ] = None,
    drag: Annotated[
        Path | None, option("A drag file to write, for reduced.drag_from of cases like this.", "none")
    ] = None,
    as_json: AsJson = False,
    overrides: Overrides = None,
) -> None:
    """Compute the resistance matrix R of all bodies, F = R U, and its inverse, the mobility.

    F are the external loads that unit motions of the bodies need at time 0 between walls at rest, or open
    where the case has them open; its velocities of walls, its motions and loads of bodies are ignored. The
    errors of all entries are estimated with another degree; the largest of R, over the diagonal, is held to
    discretisation.tolerance.
    In a container of given radius the change of R with half that radius is reported, as by fsi solve.

    With --drag also the drag with which the reduced model of the case, its laws and its cutoff, has the same
    mean mobility of the bodies.
    """
    from fsi.observables.resistance import difference
    from fsi.observables.truncation import halved
    from fsi.report.resistance import print_resistance, require_format, resistance_json, write_resistance

    if output is not None:
        require_writable(output)
        require_format(output)
    if drag is not None:
        require_writable(drag)
    case = load_with_flow(case_file, overrides, "resistance")
    if not case.bodies:
        raise InputError("bodies: there are none; a resistance matrix needs at least one [[bodies]]")
    from fsi.models import flow_solvers

    write_drag = None if drag is None else _drag_writer(case, case_file, drag)
    solve = flow_solvers(case)
    solved = solve.resistance_with_errors(case)
    found, half = solved.resistance, halved(solved.case)
    truncation = None if half is None else difference(found.R, solve.resistance(half).R, found.modes.scale)
    data = resistance_json(case.name, found, solved.errors, truncation)
    if output is not None:
        parallel.on_root(lambda: write_resistance(output, data))
    file = None if write_drag is None else write_drag(found, solved.errors)
    if file is not None:
        data |= {"drag": file.drag, "drag_error": file.error}
    if parallel.is_root() and as_json:
        typer.echo(json_text(data))
    elif parallel.is_root():
        print_resistance(standard_output(), case.name, found, solved.errors, truncation)
        if file is not None:
            typer.echo(
                f"drag = {file.drag:.6g} ± {file.error:.0e}, with the same mean mobility; wrote {drag}"
            )


def _drag_writer(
    case: Case, case_file: Path, drag: Path
) -> Callable[[Resistance, ResistanceErrors], DragFile]:
    """What writes the drag of a case, from its resistance. Raises InputError: no reduced model has one."""
    from fsi.calibration.drag import calibrated_drag, reduced_model
    from fsi.case.drag_file import save_drag

    model = reduced_model(case)

    def write(found: Resistance, errors: ResistanceErrors) -> DragFile:
        file = calibrated_drag(model, found, errors, case_file)
        parallel.on_root(lambda: save_drag(drag, file))
        return file

    return write


def mesh(
    source: Annotated[
        Path, typer.Argument(metavar="CASE|RUN", help="A case file, or a run folder.", show_default=False)
    ],
    output: Annotated[Path, output_to("The mesh file: .msh or .vtu")],
    step: Annotated[int | None, option("Which step of a run.", "the last with fields")] = None,
    overrides: Overrides = None,
) -> None:
    """Write the mesh of a case at time 0, or the one that a run used at a step."""
    require_writable(output)
    # On every rank, also where root alone writes: PETSc starts on all of them together as it is loaded.
    from fsi.meshes.files.write import require_suffix, write_mesh

    if source.is_dir():
        from fsi.postprocess.export import write_step_mesh

        if overrides:
            raise InputError(f"--set {overrides[0]}: a run is what it is; give a case file to change a value")
        written = parallel.on_root(lambda: write_step_mesh(source, step, output))
        message = f"wrote {output}, step {written}"
    else:
        from fsi.stokes.meshes import CaseMeshes

        if step is not None:
            raise InputError(f"--step {step}: a case has no steps; give a run folder")
        case = load_meshed(source, overrides)
        require_suffix(output)
        write_mesh(CaseMeshes(case).mesh(case.configuration()), output, case.names)
        message = f"wrote {output}"
    tell(message)
