"""What several commands take: a case, changes of it, a run folder, a file to write."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import fsi.parallel as parallel
from fsi.cli.loading import kept, loading
from fsi.errors import InputError
from fsi.machine.ranks import forget

if TYPE_CHECKING:  # what a command needs is imported in it: `fsi --help` must be quick
    from fsi.case.case import Case
    from fsi.workers.pools import Pool


def option(text: str, default: str | bool = True, *names: str, **more: Any) -> Any:
    """An option with its help; `default` says what holds if it is not given, False nothing."""
    return typer.Option(*names, help=text, show_default=default, **more)


def output_to(text: str, default: str | bool = True) -> Any:
    """The option --output, a file or a folder."""
    return option(text, default, "--output", "-o")


CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="A case file (TOML).", show_default=False)]
RunFolder = Annotated[
    Path, typer.Argument(metavar="RUN", help="A folder made by fsi run.", show_default=False)
]
Overrides = Annotated[
    list[str] | None,
    option(
        "Change a value of the case, e.g. discretisation.degree=2, bodies.0.radius=2; none leaves a key out. "
        "May be repeated.",
        False,
        "--set",
        metavar="KEY=VALUE",
    ),
]
Step = Annotated[int | None, option("Which step.", "the last with fields")]
Scheduler = Annotated[
    str | None, option("Let the workers of this Dask scheduler do it.", "this machine", metavar="ADDRESS")
]
AsJson = Annotated[bool, option("Print one JSON object and nothing else.", True, "--json")]


def tell(line: str) -> None:
    """Print a line, on root."""
    if parallel.is_root():
        typer.echo(line)


def warn(line: str) -> None:
    """Say on stderr, on root, that what follows takes long."""
    if parallel.is_root():
        typer.echo(f"note: {line}", err=True)


def pool_of(scheduler: str | None, workers: int | None, ranks: int = 1) -> Pool:
    """What opens who does the runs of a study. Raises InputError: both are given, or there is no mpiexec."""
    from fsi.workers.launch import mpiexec
    from fsi.workers.pools import cluster, local

    if scheduler is not None:
        if workers is not None:
            raise InputError(f"--workers {workers}: the cluster has its own; drop it, or --scheduler")
        return lambda: cluster(scheduler)
    forget()
    if ranks > 1:
        mpiexec()
    return lambda: local(workers or max((os.cpu_count() or 1) // ranks, 1))


def load(path: Path, overrides: list[str] | None, folder: Path | None = None) -> Case:
    """The case of a file, with changes; all ranks. Says beforehand where it takes long.

    folder: where a run of it is written, which must have room for it.
    """
    with loading():
        from fsi.case.checks.work import check_work, require_room
        from fsi.case.load import load_case

    with kept():
        case = parallel.on_root(lambda: load_case(path, overrides or ()))
        warning = parallel.on_root(lambda: check_work(case))
        if folder is not None:
            parallel.on_root(lambda: require_room(case, folder))
    if warning is not None:
        warn(warning)
    return case


def load_with_flow(path: Path, overrides: list[str] | None, command: str) -> Case:
    """The case of a file, for a command that needs a flow. Raises InputError: its level has none."""
    case = load(path, overrides)
    if not case.level.flow:
        raise InputError(
            f'model = "{case.model}": `fsi {command}` is for a level with a flow; add --set model=resolved, '
            "or use `fsi run`"
        )
    return case


def load_meshed(path: Path, overrides: list[str] | None) -> Case:
    """The case of a file, for a command that meshes its fluid. Raises InputError: its level has no mesh."""
    case = load(path, overrides)
    if not case.level.meshed:
        raise InputError(
            f'model = "{case.model}": only the resolved level has a mesh; add --set model=resolved'
        )
    return case


def require_writable(output: Path) -> None:
    """Raise InputError if no file can be written there."""
    if output.is_dir() or not os.access(output.absolute().parent, os.W_OK):
        raise InputError(f"output = {output}: no file can be written there; give another path")


def numbers(option: str, text: str, count: int) -> list[float]:
    """So many finite numbers with commas between them. Raises InputError."""
    try:
        found = [float(word) for word in text.split(",")]
    except ValueError:
        found = []
    if len(found) != count or not all(map(math.isfinite, found)):
        raise InputError(f"{option} {text}: give {count} numbers with commas between them, without blanks")
    return found
