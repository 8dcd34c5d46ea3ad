"""`fsi sweep`: one case for many values of its keys and many seeds, in one table."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import fsi.parallel as parallel
from fsi.case.quantities import names_of_quantities
from fsi.cli.arguments import CaseFile, Overrides, Scheduler, option, output_to, pool_of
from fsi.errors import InputError, SolveError
from fsi.report.console import standard_output

if TYPE_CHECKING:
    from fsi.studies.sweep import SweepPlan, SweepRow, SweptKey
    from fsi.workers.pools import Pool

EXAMPLE = (
    "Example: fsi sweep cases/suspensions/fractions.toml --vary arrangement.area_fraction=0.2,0.4 --seeds 10 "
    '--quantity "apparent viscosity"'
)


COMMAND = "sweep-run"


def sweep(
    case_file: CaseFile,
    quantity: Annotated[
        list[str],
        option(f"What is wanted, as in [[expected]] rows: {names_of_quantities()}. May be repeated.", False),
    ],
    vary: Annotated[
        list[str] | None,
        option(
            "A key and its values. May be repeated: all combinations are run.",
            False,
            metavar="KEY=A,B,C",
        ),
    ] = None,
    seeds: Annotated[
        int, option("Each with so many seeds of [arrangement].", "its own", min=0, max=10_000)
    ] = 0,
    motion: Annotated[
        bool,
        option(
            "Run each case to its end: rates are averaged over time, what bodies have is that at the end.",
            "solve it at time 0",
            "--run",
        ),
    ] = False,
    output: Annotated[Path | None, output_to("The folder of the sweep.", "runs/sweep/<case file>")] = None,
    workers: Annotated[int | None, option("How many runs at a time.", "one for each CPU", min=1)] = None,
    ranks: Annotated[int, option("MPI ranks of each run.", min=1)] = 1,
    scheduler: Scheduler = None,
    overrides: Overrides = None,
) -> None:
    """Run a case for all combinations of values and seeds, and average over the seeds.

    Writes sweep.csv (mean, standard error, deviation, count), runs.csv (each run with its folder) and
    sweep.png. A run that is done is never done again: a sweep that was killed goes on when the command is
    repeated, also with more values, seeds or quantities. Runs that fail are named, the others go on.
    """
    from fsi.postprocess.plots.sweep import plot_sweep
    from fsi.report.sweep import print_averages, write_tables
    from fsi.studies.sweep import SweepPlan, averages

    if parallel.size() > 1:
        raise InputError("fsi sweep: starts its processes itself; run it without mpiexec, with --ranks")
    pool = pool_of(scheduler, workers, ranks)
    keys = [_swept_key(text) for text in vary or ()]
    folder = output or Path("runs") / "sweep" / case_file.stem
    plan = SweepPlan(case_file, overrides or (), keys, seeds, tuple(dict.fromkeys(quantity)), motion, folder)
    rows = _done(plan, pool, ranks)
    found = averages(plan, rows)
    write_tables(plan, rows, found)
    plot_sweep(plan, rows, found, folder / "sweep.png")
    print_averages(standard_output(), plan, found)
    typer.echo(f"wrote {folder}: sweep.csv, runs.csv, sweep.png, and a folder for each of {len(rows)} runs")
    _require_all(rows, folder)


def sweep_run(folder: Path) -> None:
    """Do one run of a sweep in its folder; ends when standard input does."""
    from fsi.studies.member import compute
    from fsi.workers.launch import end_with_parent

    end_with_parent()
    compute(folder)


def _swept_key(text: str) -> SweptKey:
    """A key and its values. Raises InputError."""
    from fsi.case.load import toml_values
    from fsi.studies.sweep import SweptKey

    key, _, values = (part.strip() for part in text.partition("="))
    try:
        found = toml_values(values)
    except ValueError:
        found = []
    if not key or not found:
        raise InputError(f"--vary {text}: no key and values; write KEY=A,B,C, the values as in TOML")
    if any(value in found[:k] for k, value in enumerate(found)):
        raise InputError(f"--vary {text}: has a value twice; drop one of them")
    return SweptKey(key, found)


def _done(plan: SweepPlan, pool: Pool, ranks: int) -> list[SweepRow]:
    """All runs of a plan after those that were not done yet have been done."""
    from fsi.files import require_folder
    from fsi.report.progress import counting
    from fsi.studies.sweep import SweepRow
    from fsi.workers.launch import outcomes

    _require_sections(plan)
    requests = plan.requests()
    require_folder(plan.folder)
    for request in requests:
        request.require_same()
    left = [request.folder for request in requests if len(request.result()) < len(plan.quantities)]
    failures: dict[Path, str] = {}
    with counting("runs") as show:
        show(there := len(requests) - len(left), len(requests))
        if left:
            with pool() as open_pool:
                for request in requests:
                    request.write()
                for failed, said in outcomes(open_pool, COMMAND, left, ranks):
                    failures[failed] = said
                    show(there := there + 1, len(requests))
    return [SweepRow(request, request.result(), failures.get(request.folder, "")) for request in requests]


def _require_sections(plan: SweepPlan) -> None:
    """Raise InputError where the case lacks a section that an option is for."""
    from fsi.case.case import MODELS
    from fsi.case.load import case_data
    from fsi.levels import VISCOUS

    data = case_data(plan.case, plan.overrides, plan.points()[0])
    if plan.seeds and "arrangement" not in data:
        raise InputError(f"--seeds {plan.seeds}: needs [arrangement], which has a seed; add one, or drop it")
    if plan.motion and "time" not in data:
        instead = ", or drop it" if data.get("model", MODELS[0]) in VISCOUS else ""
        raise InputError(f"--run: needs a section [time] with its end; add one{instead}")


def _require_all(rows: list[SweepRow], folder: Path) -> None:
    """Raise SolveError if any run failed, or has not all quantities."""
    failed = [row for row in rows if not row.done]
    if failed:
        first = f"first {failed[0].request.folder.name}: {failed[0].failure}"
        raise SolveError(
            f"{len(failed)} of {len(rows)} runs failed, {first}; all stand in {folder / 'runs.csv'}, "
            "and are tried again when the command is repeated"
        )
