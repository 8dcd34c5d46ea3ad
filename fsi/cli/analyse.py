"""`fsi analyse`: what a run tells beyond its tables."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import AsJson, RunFolder, option
from fsi.files import json_text

if TYPE_CHECKING:
    from rich.table import Table

    from fsi.postprocess.run.run import Run

EXAMPLE = "Example: fsi analyse settling runs/settling_disc"

analyse = typer.Typer(
    name="analyse",
    help="Tell which chains of discs resist, how long contacts remember, or how well a body settles.\n\n"
    "Prints a table, and draws a picture into the run folder: chains.png, memory.png or settling.png.",
    epilog=EXAMPLE,
    add_completion=False,
    rich_markup_mode="markdown",
)


@analyse.command(epilog="Example: fsi analyse chains runs/couette_N10 --step 5")
def chains(
    folder: RunFolder,
    step: Annotated[int | None, option("Which step.", "the one that dissipates most")] = None,
    as_json: AsJson = False,
) -> None:
    """Find the chains of close discs that resist at a step: what the flow costs in them.

    A chain is of discs linked by gaps below a tenth of the mean radius. Of each: what is dissipated in it, in
    runs of pores in the fluid of its necks, else by lubrication along lines of centres; and in a sheared
    suspension the part of the apparent viscosity that lubrication forces carry along it. In a channel the
    chain from wall to wall is told besides, that whose least link dissipates most.
    """
    from fsi.postprocess.analysis.chains import chains_data, chains_table, read_chains
    from fsi.postprocess.plots.analyses import plot_chains

    _show(
        folder,
        "chains.png",
        as_json,
        lambda run: read_chains(run, step),
        (plot_chains, chains_table, chains_data),
    )


@analyse.command(epilog="Example: fsi analyse memory runs/layers")
def memory(folder: RunFolder, as_json: AsJson = False) -> None:
    """Tell how long the contacts of a gluey run remember.

    A contact that was pressed with the impulse P stays closed until an equal pull has been paid back. Of
    contacts in the order of their release: the largest stored impulse P = -gamma, when it was reached, when
    the contact came off, the time lag in between, and P over the lag: the mean pull. Times are those of
    output, so good to output.interval.
    """
    from fsi.postprocess.analysis.memory import memory_data, memory_table, read_memories
    from fsi.postprocess.plots.analyses import plot_memories

    _show(folder, "memory.png", as_json, read_memories, (plot_memories, memory_table, memory_data))


@analyse.command(epilog=EXAMPLE)
def settling(folder: RunFolder, as_json: AsJson = False) -> None:
    """Compare the gap of a disc or sphere that settles onto a plane with the exact law.

    The run is of one body above the plane of a half-plane under a constant normal force, in a viscous fluid.
    """
    from fsi.postprocess.analysis.settling import read_settling, settling_data, settling_table
    from fsi.postprocess.plots.analyses import plot_settling

    _show(folder, "settling.png", as_json, read_settling, (plot_settling, settling_table, settling_data))


def _show[T](
    folder: Path,
    picture: str,
    as_json: bool,
    read: Callable[[Run], T],
    tell: tuple[Callable[[T, Path], None], Callable[[T], Table], Callable[[T], dict[str, Any]]],
) -> None:
    """Draw an analysis of a run, and print its table or its data, on root; tell: plot, table, data."""
    from fsi.postprocess.run.run import open_run
    from fsi.report.console import standard_output

    plot, table, data = tell

    def work() -> T:
        result = read(open_run(folder))
        plot(result, folder / picture)
        return result

    result = parallel.on_root(work)
    if parallel.is_root() and as_json:
        typer.echo(json_text(data(result)))
    elif parallel.is_root():
        standard_output().print(table(result))
        typer.echo(f"picture: {folder / picture}")
