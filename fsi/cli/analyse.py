"""`fsi analyse`: what a run tells beyond its tables."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import fsi.parallel as parallel
from fsi.cli.arguments import AsJson, RunFolder

if TYPE_CHECKING:
    from rich.table import Table

EXAMPLE = "Example: fsi analyse settling runs/settling_disc"

analyse = typer.Typer(
    help="Tell which chains of discs resist, how long contacts remember, or how well a disc settles.\n\n"
    "Prints a table, and draws a picture into the run folder: chains.png, memory.png or settling.png.",
    epilog=EXAMPLE,
    no_args_is_help=True,
)


@analyse.command(epilog="Example: fsi analyse chains runs/couette_N10 --step 5")
def chains(
    folder: RunFolder,
    step: Annotated[
        int | None, typer.Option(help="Which step.", show_default="the one that dissipates most")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Find the chains of close discs that resist at a step: what lubrication costs in them.

    A chain is of discs linked by gaps below a tenth of the mean radius. Of each: what lubrication dissipates
    in it and, in a sheared suspension, the part of the apparent viscosity that its forces carry along it.
    """
    from fsi.postprocess.analysis.chains import chains_data, chains_table, read_chains
    from fsi.postprocess.plots.analyses import plot_chains
    from fsi.postprocess.run.run import open_run

    def work(picture: Path) -> tuple[Table, dict[str, Any]]:
        chains = read_chains(open_run(folder), step)
        plot_chains(chains, picture)
        return chains_table(chains), chains_data(chains)

    _show(work, folder / "chains.png", as_json)


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
    from fsi.postprocess.run.run import open_run

    def work(picture: Path) -> tuple[Table, dict[str, Any]]:
        memories = read_memories(open_run(folder))
        plot_memories(memories, picture)
        return memory_table(memories), memory_data(memories)

    _show(work, folder / "memory.png", as_json)


@analyse.command(epilog=EXAMPLE)
def settling(folder: RunFolder, as_json: AsJson = False) -> None:
    """Compare the gap of a disc that settles onto a plane with the exact law.

    The run is of one disc above the plane of a half-plane under a constant normal force.
    """
    from fsi.postprocess.analysis.settling import read_settling, settling_data, settling_table
    from fsi.postprocess.plots.analyses import plot_settling
    from fsi.postprocess.run.run import open_run

    def work(picture: Path) -> tuple[Table, dict[str, Any]]:
        history = read_settling(open_run(folder))
        plot_settling(history, picture)
        return settling_table(history), settling_data(history)

    _show(work, folder / "settling.png", as_json)


def _show(work: Callable[[Path], tuple[Table, dict[str, Any]]], picture: Path, as_json: bool) -> None:
    """Print the table of an analysis, or its data, on root."""
    table, data = parallel.on_root(lambda: work(picture))
    if not parallel.is_root():
        return
    if as_json:
        typer.echo(json.dumps(data))
        return
    from fsi.report.console import standard_output

    standard_output().print(table)
    typer.echo(f"picture: {picture}")
